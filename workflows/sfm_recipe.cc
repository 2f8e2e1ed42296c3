#include "workflows/recipes.h"
#include "workflows/stages/features.h"
#include "workflows/stages/free_cameras.h"
#include "workflows/stages/gates.h"
#include "workflows/surface_recipe.h"

namespace rigmap {
namespace {

struct FreeCameras {
  PartInputs in;
  Node<PosedPart> posed;
  Node<Report> gates;
};

// images -> COLMAP's own features and matches -> models -> metres -> trajectory, judged
FreeCameras AddFreeCameras(StageGraph& g, const Dataset& data, const DatasetContent& content,
                           const PartOptions& o) {
  const PartInputs in = AddPartInputs(g, data, content, o.colmap);
  const auto matches =
      g.AddStage(FreeMatching(), Reading(o.free_matching), in.colmap, in.dataset, in.content);
  const auto models =
      g.AddStage(FreeMapping(), Reading(o.free_mapping), in.colmap, in.dataset, matches);
  const auto aligned = g.AddStage(FreeScale(), Reading(o.scale), in.dataset, models);
  const auto part = g.AddStage(FreeTrajectory(), Reading(), in.dataset, models, aligned);
  const auto gates = g.AddCheck(FreeCameraGates(),
                                Reading(o.gates.mapping, o.gates.poses, o.gates.adjustment,
                                        o.gates.calibration, o.adjustment),
                                in.dataset, models, aligned, part);
  return {in, g.AddView(PosedByAdjustment, in.dataset, part), gates};
}

}  // namespace

StageGraph SfmRecipe(const Dataset& data, const DatasetContent& content, const PartOptions& o) {
  StageGraph g;
  const FreeCameras free = AddFreeCameras(g, data, content, o);
  AddEvaluation(g, o, free.in.dataset, free.in.truth, free.posed);
  return g;
}

StageGraph CombinedRecipe(const Dataset& data, const DatasetContent& content,
                          const PartOptions& o) {
  StageGraph g;
  const FreeCameras free = AddFreeCameras(g, data, content, o);
  // what belongs to the rover, and what cannot be read, for dense matching
  const auto found =
      g.AddStage(Features(), Reading(o.features, o.masks), free.in.dataset, free.in.content);
  AddSurface(g, o,
             {free.in.dataset, free.in.content, free.in.truth, free.in.fixes, found, free.posed,
              free.gates});
  return g;
}

}  // namespace rigmap
