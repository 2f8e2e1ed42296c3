#include "workflows/recipes.h"
#include "workflows/stages/features.h"
#include "workflows/stages/gates.h"
#include "workflows/stages/odometry.h"
#include "workflows/stages/tracked_features.h"
#include "workflows/stages/trajectory.h"
#include "workflows/surface_recipe.h"

namespace rigmap {
namespace {

// The odometry laid into the world as it is, judged, and a map on its poses.
void AddOdometricPart(StageGraph& g, const PartOptions& o, const PartInputs& in,
                      Node<FeatureIndex> found, Node<FeatureStore> features,
                      Node<Odometry> odometry) {
  const auto part = g.AddStage(OdometricTrajectory(), Reading(o.odometry, o.adjustment), in.dataset,
                               features, odometry);
  const auto gates =
      g.AddCheck(OdometricGates(),
                 Reading(o.gates.mapping, o.gates.poses, o.gates.adjustment, o.gates.calibration),
                 in.dataset, found, odometry, part);
  const auto posed = g.AddView(PosedByOdometry, in.dataset, part);
  AddSurface(g, o, {in.dataset, in.content, in.truth, in.fixes, found, posed, gates});
}

}  // namespace

StageGraph VisualOdometryRecipe(const Dataset& data, const DatasetContent& content,
                                const PartOptions& o) {
  StageGraph g;
  const PartInputs in = AddPartInputs(g, data, content, o.colmap);
  // images -> keypoints with stereo matches -> metric motion from frame to keyframe
  const auto found = g.AddStage(Features(), Reading(o.features, o.masks), in.dataset, in.content);
  const auto features = g.AddView(OpenFeatures, found);
  const auto odometry = g.AddStage(VisualOdometry(), Reading(o.odometry), in.dataset, features);
  AddOdometricPart(g, o, in, found, features, odometry);
  return g;
}

StageGraph KltRecipe(const Dataset& data, const DatasetContent& content, const PartOptions& o) {
  StageGraph g;
  const PartInputs in = AddPartInputs(g, data, content, o.colmap);
  // images -> corners followed from frame to frame -> metric motion from frame to keyframe
  const auto found = g.AddStage(TrackedFeatures(), Reading(o.corners, o.features, o.masks),
                                in.dataset, in.content);
  const auto features = g.AddView(OpenFeatures, found);
  const auto odometry = g.AddStage(TrackedOdometry(), Reading(o.odometry), in.dataset, features);
  AddOdometricPart(g, o, in, found, features, odometry);
  return g;
}

}  // namespace rigmap
