#include "workflows/surface_recipe.h"

#include "workflows/stages/depth_maps.h"
#include "workflows/stages/evaluation.h"
#include "workflows/stages/gates.h"
#include "workflows/stages/georeference.h"
#include "workflows/stages/las.h"
#include "workflows/stages/raster.h"
#include "workflows/stages/views.h"

namespace rigmap {

void AddSurface(StageGraph& g, const PartOptions& o, const SurfaceInputs& in) {
  const auto depths = g.AddStage(DenseMatching(), Reading(o.dense, o.masks, o.voxel), in.dataset,
                                 in.content, in.features, in.posed);
  const auto depth_gates = AddDepthProducts(g, o, in, depths);
  const auto map = g.AddStage(Fusion(), Reading(o.fusion), in.dataset, in.posed, depths);
  AddMapProducts(g, o, in, depth_gates, map);
}

Node<Report> AddDepthProducts(StageGraph& g, const PartOptions& o, const SurfaceInputs& in,
                              Node<DepthIndex> depths) {
  g.AddStage(DepthMaps(), Reading(o.depth_maps), in.dataset, in.posed, depths);
  return g.AddCheck(DepthGates(), Reading(o.gates.dense), depths);
}

void AddMapProducts(StageGraph& g, const PartOptions& o, const SurfaceInputs& in,
                    Node<Report> depth_gates, Node<FusedMap> map) {
  const auto warning = g.AddView(WarningByGates, in.gates, depth_gates);
  const auto earth = g.AddStage(GeoreferenceStage(), Reading(o.georeference, o.earth, o.rocks),
                                in.dataset, in.fixes, in.posed, map, warning);
  g.AddStage(Rasters(), Reading(o.raster, o.terrain), in.posed, map, warning, earth);
  g.AddStage(LasFile(), Reading(o.las), map, warning, earth);
  g.AddStage(Pictures(), Reading(o.pictures), in.posed, map, warning);
  const auto steps = in.steps ? *in.steps : g.AddView(NoSteps, in.posed);
  g.AddStage(Evaluation(), Reading(o.evaluation, o.georeference, o.rocks, o.rock_survey),
             in.dataset, in.truth, in.posed, steps, map);
}

void AddEvaluation(StageGraph& g, const PartOptions& o, Node<Dataset> dataset, Node<Truth> truth,
                   Node<PosedPart> posed) {
  g.AddStage(Evaluation(), Reading(o.evaluation, o.georeference, o.rocks, o.rock_survey), dataset,
             truth, posed, g.AddView(NoSteps, posed), g.AddView(NoMap, posed));
}

}  // namespace rigmap
