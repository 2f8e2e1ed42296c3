// The second half of every technique: from poses to a map.
#pragma once

#include "workflows/part_options.h"
#include "workflows/stages/features.h"
#include "workflows/stages/inputs.h"
#include "workflows/stages/posed_part.h"

namespace rigmap {

struct SurfaceInputs {
  Node<Dataset> dataset;
  Node<DatasetContent> content;
  Node<Truth> truth;
  Node<FeatureIndex> features;
  Node<PosedPart> posed;
  Node<Report> gates;  // of the poses
};

// Adds dense, fusion, raster, views and evaluation.
void AddSurface(StageGraph& graph, const PartOptions& options, const SurfaceInputs& inputs);

}  // namespace rigmap
