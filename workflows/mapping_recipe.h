// What the techniques share that map with COLMAP: from odometry to keyframes in metres.
#pragma once

#include "features/feature_store.h"
#include "workflows/part_options.h"
#include "workflows/stages/inputs.h"
#include "workflows/stages/mapping.h"

namespace rigmap {

struct MappingInputs {
  Node<Dataset> dataset;
  Node<ColmapInstallation> colmap;
  Node<FeatureStore> features;
  Node<Odometry> odometry;
};

struct MappedKeyframes {
  Node<Correspondences> matches;
  Node<KeyframeGraph> graph;
  Node<MeasuredModels> models;
  Node<AlignedKeyframes> aligned;
};

// Adds matching, database, mapping and scale.
MappedKeyframes AddMappedKeyframes(StageGraph& graph, const PartOptions& options,
                                   const MappingInputs& inputs);

}  // namespace rigmap
