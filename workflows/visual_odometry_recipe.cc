#include "workflows/recipes.h"
#include "workflows/stages/features.h"
#include "workflows/stages/gates.h"
#include "workflows/stages/odometry.h"
#include "workflows/stages/trajectory.h"
#include "workflows/surface_recipe.h"

namespace rigmap {

StageGraph VisualOdometryRecipe(const Dataset& data, const DatasetContent& data_content,
                                const PartOptions& o) {
  StageGraph g;
  const auto [dataset, content, truth, colmap] = AddPartInputs(g, data, data_content, o.colmap);

  // images -> keypoints with stereo matches -> metric motion from frame to keyframe
  const auto found = g.AddStage(Features(), Reading(o.features, o.masks), dataset, content);
  const auto features = g.AddView(OpenFeatures, found);
  const auto odometry = g.AddStage(VisualOdometry(), Reading(o.odometry), dataset, features);

  // laid into the world as they are
  const auto part =
      g.AddStage(OdometricTrajectory(), Reading(o.odometry), dataset, features, odometry);
  const auto gates =
      g.AddCheck(OdometricGates(),
                 Reading(o.gates.mapping, o.gates.poses, o.gates.adjustment, o.gates.calibration),
                 dataset, found, odometry, part);
  const auto posed = g.AddView(PosedByOdometry, dataset, part);

  // depth of the keyframes, fused on the poses -> coloured map, judged
  AddSurface(g, o, {dataset, content, truth, found, posed, gates});
  return g;
}

}  // namespace rigmap
