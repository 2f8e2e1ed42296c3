#include "workflows/mapping_recipe.h"
#include "workflows/recipes.h"
#include "workflows/stages/adjustment.h"
#include "workflows/stages/features.h"
#include "workflows/stages/gates.h"
#include "workflows/stages/odometric_adjustment.h"
#include "workflows/stages/odometry.h"
#include "workflows/stages/pose_graph.h"
#include "workflows/stages/sensor_gates.h"
#include "workflows/surface_recipe.h"

namespace rigmap {

StageGraph RigRecipe(const Dataset& data, const DatasetContent& data_content,
                     const PartOptions& o) {
  StageGraph g;
  const auto [dataset, content, truth, fixes, colmap] =
      AddPartInputs(g, data, data_content, o.colmap);

  // images -> keypoints with stereo matches -> metric motion from frame to keyframe, that of
  // lone images and the rover's sensors where these lose their way
  const auto found = g.AddStage(Features(), Reading(o.features, o.masks), dataset, content);
  const auto features = g.AddView(OpenFeatures, found);
  const auto seen = g.AddStage(VisualOdometry(), Reading(o.odometry), dataset, features);
  const auto odometry = g.AddStage(
      Bridging(), Reading(o.features, o.corners, o.masks, o.odometry, o.dead_reckoning, o.filter),
      dataset, features, seen);

  // verified correspondences -> COLMAP's database -> poses in COLMAP's gauge -> metres; where these
  // fail a gate, the adjustment starts from the odometry
  const auto [matches, graph, models, aligned] =
      AddMappedKeyframes(g, o, {dataset, colmap, features, odometry});

  // one pose per frame, the rig held -> trajectory and sparse model
  const auto from_odometry =
      g.AddStage(OdometricAdjustment(),
                 Reading(o.features, o.corners, o.masks, o.matching, o.adjustment, o.odometry,
                         o.dead_reckoning, o.filter),
                 dataset, features, odometry, matches);
  const auto start =
      o.mapping.method != MappingMethod::kNone ? StartingFrom::kMapping : StartingFrom::kOdometry;
  const auto adjusted = g.AddStage(
      RigAdjustment(),
      Reading(start, o.features, o.corners, o.masks, o.matching, o.adjustment, o.odometry,
              o.dead_reckoning, o.filter, o.gates.mapping, o.gates.adjustment),
      dataset, content, features, odometry, matches, graph, aligned, from_odometry);
  const auto own_gates =
      g.AddCheck(AdjustedGates(),
                 Reading(o.gates.mapping, o.gates.poses, o.gates.adjustment, o.gates.calibration),
                 dataset, found, aligned, adjusted);
  const auto gates =
      g.AddView(WithMoreGates, own_gates,
                g.AddCheck(SensorGates(), Reading(o.dead_reckoning, o.filter), dataset, adjusted));
  const auto posed = g.AddView(PosedByAdjustment, dataset, adjusted);

  g.AddStage(PartPoseGraph(), Reading(), adjusted);
  const auto steps = g.AddStage(TrajectorySteps(), Reading(), odometry, graph, aligned, adjusted);

  // depth of the keyframes, fused on the poses -> coloured map, judged
  AddSurface(g, o, {dataset, content, truth, fixes, found, posed, gates, steps});
  return g;
}

}  // namespace rigmap
