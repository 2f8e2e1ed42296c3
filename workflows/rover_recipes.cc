#include "workflows/recipes.h"
#include "workflows/stages/dead_reckoning.h"
#include "workflows/stages/features.h"
#include "workflows/stages/gates.h"
#include "workflows/stages/odometry.h"
#include "workflows/surface_recipe.h"

namespace rigmap {
namespace {

// A map on the poses of a rover, judged by what these know of themselves.
void AddRoverSurface(StageGraph& g, const PartOptions& o, const PartInputs& in,
                     Node<FeatureIndex> found, Node<DeadReckonedPart> rover,
                     const OdometricGatesCheck& check) {
  const auto part = g.AddView(PartOfRover, rover);
  const auto steps = g.AddView(StepsOfRover, rover);
  const auto gates = g.AddCheck(
      check, Reading(o.gates.mapping, o.gates.poses, o.gates.adjustment, o.gates.calibration),
      in.dataset, found, steps, part);
  const auto posed = g.AddView(PosedByRover, in.dataset, rover);
  AddSurface(g, o, {in.dataset, in.content, in.truth, in.fixes, found, posed, gates});
}

}  // namespace

StageGraph WheelsRecipe(const Dataset& data, const DatasetContent& data_content,
                        const PartOptions& o) {
  StageGraph g;
  const PartInputs in = AddPartInputs(g, data, data_content, o.colmap);

  // wheels, gyro, inclinometer -> poses; the images are for the map alone
  const auto rover = g.AddStage(DeadReckoning(), Reading(o.dead_reckoning), in.dataset);
  const auto found = g.AddStage(Features(), Reading(o.features, o.masks), in.dataset, in.content);

  AddRoverSurface(g, o, in, found, rover, DeadReckonedGates());
  return g;
}

StageGraph FilterRecipe(const Dataset& data, const DatasetContent& data_content,
                        const PartOptions& o) {
  StageGraph g;
  const PartInputs in = AddPartInputs(g, data, data_content, o.colmap);

  // images -> keypoints with stereo matches -> metric motion from frame to keyframe
  const auto found = g.AddStage(Features(), Reading(o.features, o.masks), in.dataset, in.content);
  const auto features = g.AddView(OpenFeatures, found);
  const auto odometry = g.AddStage(VisualOdometry(), Reading(o.odometry), in.dataset, features);

  // fused with wheels, gyro and inclinometer
  const auto rover =
      g.AddStage(Filter(), Reading(o.dead_reckoning, o.filter, o.odometry, o.adjustment),
                 in.dataset, features, odometry);

  g.AddCheck(FilterGates(), Reading(), rover, odometry);
  AddRoverSurface(g, o, in, found, rover, OdometricGates());
  return g;
}

}  // namespace rigmap
