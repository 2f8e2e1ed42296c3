#include "workflows/recipes.h"
#include "workflows/stages/adjustment.h"
#include "workflows/stages/features.h"
#include "workflows/stages/gates.h"
#include "workflows/stages/mapping.h"
#include "workflows/stages/matching.h"
#include "workflows/stages/odometry.h"
#include "workflows/stages/scale.h"
#include "workflows/surface_recipe.h"

namespace rigmap {

StageGraph RigRecipe(const Dataset& data, const DatasetContent& data_content,
                     const PartOptions& o) {
  StageGraph g;
  const auto [dataset, content, truth, colmap] = AddPartInputs(g, data, data_content, o.colmap);

  // images -> keypoints with stereo matches -> metric motion from frame to keyframe
  const auto found = g.AddStage(Features(), Reading(o.features, o.masks), dataset, content);
  const auto features = g.AddView(OpenFeatures, found);
  const auto odometry = g.AddStage(VisualOdometry(), Reading(o.odometry), dataset, features);

  // verified correspondences -> COLMAP's database -> poses in COLMAP's gauge -> metres
  const auto matches = g.AddStage(Matching(), Reading(o.matching), dataset, features, odometry);
  const auto graph =
      g.AddStage(Database(), Reading(o.keyframe_graph), colmap, dataset, odometry, matches);
  const InTurn mapping_ways{o.mapping.method, MappingMethod::kTriangulate};
  const auto models = g.AddStage(
      Mapping(),
      Reading(mapping_ways, o.mapping, o.matching.verification, o.scale, o.gates.mapping), colmap,
      dataset, odometry, matches, graph);
  const auto aligned = g.AddStage(Scale(), Reading(), odometry, graph, models);

  // one pose per frame, the rig held -> trajectory and sparse model
  const InTurn starts{StartingFrom::kMapping, StartingFrom::kOdometry};
  const auto adjusted =
      g.AddStage(RigAdjustment(), Reading(starts, o.adjustment, o.odometry, o.gates.adjustment),
                 dataset, content, features, odometry, matches, graph, aligned);
  const auto gates =
      g.AddCheck(AdjustedGates(),
                 Reading(o.gates.mapping, o.gates.poses, o.gates.adjustment, o.gates.calibration),
                 dataset, found, graph, aligned, adjusted);
  const auto posed = g.AddView(PosedByAdjustment, dataset, adjusted);

  // depth of the keyframes, fused on the poses -> coloured map, judged
  AddSurface(g, o, {dataset, content, truth, found, posed, gates});
  return g;
}

}  // namespace rigmap
