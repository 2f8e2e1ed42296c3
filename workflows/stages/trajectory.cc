#include "workflows/stages/trajectory.h"

#include <fmt/format.h>

#include <algorithm>

#include "adjustment/level_world.h"
#include "adjustment/unchecked_scale.h"
#include "correspondence/stereo_points.h"
#include "pipeline/code_identity.h"
#include "trajectory/assemble_trajectory.h"
#include "trajectory/starting_poses.h"
#include "workflows/stages/trajectory_output.h"

namespace rigmap {
namespace {

OdometricPart MakeOdometric(const StageContext&, const Dataset& dataset,
                            const FeatureStore& features, const Odometry& odometry,
                            const OdometryOptions& options, const AdjustmentOptions& prior) {
  Adjustment none;
  none.world_from_left.resize(odometry.size());
  std::vector<std::optional<Rigid3>> poses;
  for (const OdometryFrame& frame : odometry) poses.emplace_back(frame.world_from_left);
  std::fill_n(poses.begin(), FirstPosedFrame(odometry), std::nullopt);
  PointsInLeft seen =
      PointsOfKeyframes(dataset.rig, features, odometry, options.disparity_noise_px);
  std::vector<Eigen::Vector3d> in_gauge;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    for (const Eigen::Vector3d& x : seen[i]) in_gauge.push_back(odometry[i].world_from_left * x);
  }
  const LevelledWorld world = LevelWorld(poses, in_gauge, dataset);
  const UncheckedScale unchecked = UncheckedScaleOf(dataset.rig, odometry, prior);
  return {dataset.rig,     AssembleTrajectory(odometry, none, world.world_from_gauge),
          std::move(seen), world.up_source,
          unchecked.sigma, unchecked.asked_offset_px};
}

void PublishOdometric(Publication& publication, const StageContext&, const OdometricPart& part,
                      const Dataset&, const FeatureStore&, const Odometry&) {
  PublishTrajectory(part.rig, part.trajectory, publication);
}

Report ReportOdometric(const OdometricPart& part, const Dataset&, const FeatureStore&,
                       const Odometry&) {
  return ReportTrajectory(part.trajectory, part.world_up);
}

}  // namespace

PointsInLeft PointsOfKeyframes(const StereoRig& rig, const FeatureStore& features,
                               const Odometry& odometry, double disparity_noise_px) {
  PointsInLeft points(odometry.size());
  for (std::size_t i = 0; i < odometry.size(); ++i) {
    if (!odometry[i].keyframe) continue;
    const FrameFeatures frame = features.Get(static_cast<int>(i));
    for (const auto& point : TriangulateFeatures(frame.features, rig, disparity_noise_px)) {
      if (point) points[i].push_back(point->x_in_left);
    }
  }
  return points;
}

TrajectoryStage OdometricTrajectory() {
  return {.name = "trajectory",
          .about = "the poses of the odometry, laid into the world as they are",
          .code = CodeHere(),
          .make = MakeOdometric,
          .publishes = kTrajectoryOutputs,
          .publish = PublishOdometric,
          .report = ReportOdometric};
}

PosedPart PosedByOdometry(const StageContext&, const Dataset& dataset, const OdometricPart& part) {
  PosedPart posed{
      WithFilesOf(dataset, part.rig), part.trajectory, part.points_in_left, {}, part.world_up};
  posed.points_in_left.resize(part.trajectory.size());
  return posed;
}

Report ReportTrajectory(const Trajectory& trajectory, WorldUp world_up) {
  Report report = {{"world_up", Name(world_up)}, {"frames", {{"posed", trajectory.size()}}}};
  report["mapping"]["remarks"] = Report::array();
  const auto predicted = std::ranges::count(trajectory, PoseSource::kPredicted, &TimedPose::source);
  if (predicted > 0) {
    report["mapping"]["remarks"].push_back(
        fmt::format("{} of {} poses are predicted, since nothing measured their frames: "
                    "their sigmas say how far to trust them",
                    predicted, trajectory.size()));
  }
  return report;
}

}  // namespace rigmap
