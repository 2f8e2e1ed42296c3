// The second half of every technique: from poses to a map.
#pragma once

#include <optional>

#include "workflows/part_options.h"
#include "workflows/stages/dense.h"
#include "workflows/stages/features.h"
#include "workflows/stages/fusion.h"
#include "workflows/stages/inputs.h"
#include "workflows/stages/posed_part.h"
#include "workflows/stages/steps.h"

namespace rigmap {

struct SurfaceInputs {
  Node<Dataset> dataset;
  Node<DatasetContent> content;
  Node<Truth> truth;
  Node<Fixes> fixes;
  Node<FeatureIndex> features;
  Node<PosedPart> posed;
  Node<Report> gates;                     // of the poses
  std::optional<Node<Steps>> steps = {};  // that led to them
};

// Adds dense, fusion, georeference, raster, las, views and evaluation.
void AddSurface(StageGraph& graph, const PartOptions& options, const SurfaceInputs& inputs);

// Adds evaluation alone, for techniques that make no map.
void AddEvaluation(StageGraph& graph, const PartOptions& options, Node<Dataset> dataset,
                   Node<Truth> truth, Node<PosedPart> posed);

// The same in pieces, for a technique with depth or a map of its own: what is made and judged of
// depth maps alone, and what is made of a map. The first gives the check of the depths.
Node<Report> AddDepthProducts(StageGraph& graph, const PartOptions& options,
                              const SurfaceInputs& inputs, Node<DepthIndex> depths);
void AddMapProducts(StageGraph& graph, const PartOptions& options, const SurfaceInputs& inputs,
                    Node<Report> depth_gates, Node<FusedMap> map);

}  // namespace rigmap
