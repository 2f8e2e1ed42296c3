// What the techniques share that map with COLMAP: from images to keyframes in metres.
#pragma once

#include "workflows/part_options.h"
#include "workflows/stages/features.h"
#include "workflows/stages/inputs.h"
#include "workflows/stages/mapping.h"

namespace rigmap {

struct MappingInputs {
  Node<Dataset> dataset;
  Node<DatasetContent> content;
  Node<ColmapInstallation> colmap;
};

struct MappedKeyframes {
  Node<FeatureIndex> found;
  Node<FeatureStore> features;  // a view of these
  Node<Odometry> odometry;
  Node<Correspondences> matches;
  Node<KeyframeGraph> graph;
  Node<MeasuredModels> models;
  Node<AlignedKeyframes> aligned;
};

// Adds features, odometry, matching, database, mapping and scale.
MappedKeyframes AddMappedKeyframes(StageGraph& graph, const PartOptions& options,
                                   const MappingInputs& inputs);

}  // namespace rigmap
