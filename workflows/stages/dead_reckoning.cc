#include "workflows/stages/dead_reckoning.h"

#include "adjustment/level_world.h"
#include "adjustment/unchecked_scale.h"
#include "dead_reckoning/estimate_motion.h"
#include "pipeline/code_identity.h"
#include "workflows/stages/trajectory_output.h"

namespace rigmap {
namespace {

TimedPose PoseInWorld(StampNs stamp_ns, const EstimatedPose& pose, const Rigid3& world_from_gauge) {
  const Eigen::Matrix3d turn = world_from_gauge.rotation.toRotationMatrix();
  const auto turned = [&](const Eigen::Matrix3d& block) {
    return (turn * block * turn.transpose()).eval();
  };
  const Eigen::Matrix3d position = turned(pose.covariance.topLeftCorner<3, 3>());
  const Eigen::Matrix3d rotation = turned(pose.covariance.bottomRightCorner<3, 3>());
  TimedPose timed{.stamp_ns = stamp_ns};
  timed.world_from_left = world_from_gauge * pose.gauge_from_left;
  timed.sigmas << position.diagonal().cwiseMax(0.0).cwiseSqrt(),
      rotation.diagonal().cwiseMax(0.0).cwiseSqrt();
  timed.position_covariance = position;
  timed.source = pose.is_measured ? PoseSource::kOdometry : PoseSource::kPredicted;
  return timed;
}

DeadReckonedPart InWorld(const Dataset& dataset, const EstimatedMotion& motion) {
  std::vector<std::optional<Rigid3>> poses;
  for (const EstimatedPose& pose : motion.poses) poses.emplace_back(pose.gauge_from_left);
  const LevelledWorld world = LevelWorld(poses, {}, dataset);
  DeadReckonedPart rover{{dataset.rig, {}, {}, world.up_source},
                         motion.wheel_scale,
                         motion.wheel_scale_sigma,
                         motion.gyro_bias_radps,
                         motion.slips,
                         motion.misled};
  for (std::size_t i = 0; i < motion.poses.size(); ++i) {
    rover.part.trajectory.push_back(
        PoseInWorld(dataset.frames[i].stamp_ns, motion.poses[i], world.world_from_gauge));
  }
  return rover;
}

void ChooseKeyframes(const DeadReckoningOptions& options, Trajectory& trajectory) {
  const TimedPose* last = nullptr;
  for (TimedPose& pose : trajectory) {
    if (last) {
      const Rigid3 step = last->world_from_left.Inverse() * pose.world_from_left;
      if (step.translation.norm() < options.keyframe_step_m &&
          AngleOf(step.rotation) < options.keyframe_turn_rad) {
        continue;
      }
    }
    pose.keyframe = true;
    last = &pose;
  }
}

DeadReckonedPart MakeDeadReckoned(const StageContext&, const Dataset& dataset,
                                  const DeadReckoningOptions& options) {
  DeadReckonedPart rover = InWorld(dataset, EstimateMotion(dataset, {}, options, FilterOptions()));
  ChooseKeyframes(options, rover.part.trajectory);
  return rover;
}

// Metres are those of the images, so what is not known of the calibration counts.
DeadReckonedPart MakeFiltered(const StageContext&, const Dataset& dataset,
                              const FeatureStore& features, const Odometry& odometry,
                              const DeadReckoningOptions& options, const FilterOptions& filter,
                              const OdometryOptions& visual, const AdjustmentOptions& prior) {
  const std::vector<VisualStep> steps = VisualSteps(odometry);
  DeadReckonedPart rover = InWorld(dataset, EstimateMotion(dataset, steps, options, filter));
  rover.part.points_in_left =
      PointsOfKeyframes(dataset.rig, features, odometry, visual.disparity_noise_px);
  if (!steps.empty() && filter.use_vision) {
    rover.visual_scale_sigma = filter.vision_scale_sigma;
    const UncheckedScale unchecked = UncheckedScaleOf(dataset.rig, odometry, prior);
    rover.part.calibration_scale_sigma = unchecked.sigma;
    rover.part.asked_offset_px = unchecked.asked_offset_px;
  }
  for (std::size_t i = 0; i < odometry.size(); ++i) {
    rover.part.trajectory[i].keyframe = odometry[i].keyframe;
  }
  return rover;
}

Report ReportRover(const DeadReckonedPart& rover) {
  Report report = ReportTrajectory(rover.part.trajectory, rover.part.world_up);
  const Eigen::Vector3d& bias = rover.gyro_bias_radps;
  report["rover"] = {{"wheel_scale", rover.wheel_scale},
                     {"wheel_scale_sigma", rover.wheel_scale_sigma},
                     {"gyro_bias_radps", {bias.x(), bias.y(), bias.z()}},
                     {"slips", rover.slips},
                     {"visual_steps_refused", rover.misled}};
  return report;
}

void PublishDeadReckoned(Publication& publication, const StageContext&,
                         const DeadReckonedPart& rover, const Dataset&) {
  PublishTrajectory(rover.part.rig, rover.part.trajectory, publication);
}

void PublishFiltered(Publication& publication, const StageContext&, const DeadReckonedPart& rover,
                     const Dataset&, const FeatureStore&, const Odometry&) {
  PublishTrajectory(rover.part.rig, rover.part.trajectory, publication);
}

Report ReportDeadReckoned(const DeadReckonedPart& rover, const Dataset&) {
  const auto& trajectory = rover.part.trajectory;
  Report report = ReportRover(rover);
  report["frames"]["keyframes"] = std::ranges::count(trajectory, true, &TimedPose::keyframe);
  return report;
}

Report ReportFiltered(const DeadReckonedPart& rover, const Dataset&, const FeatureStore&,
                      const Odometry&) {
  return ReportRover(rover);
}

Report JudgeFiltered(const DeadReckonedPart& rover, const Odometry& odometry) {
  const std::size_t steps = VisualSteps(odometry).size();
  const double refused = static_cast<double>(rover.misled.size()) /
                         static_cast<double>(std::max<std::size_t>(1, steps));
  Report gate = {{"name", "sensors_contradict"},
                 {"value", refused},
                 {"limit", kMostMisled},
                 {"passed", refused <= kMostMisled},
                 {"why", "share of the images' steps that wheels and gyro contradict"}};
  return {{"gates", Report::array({std::move(gate)})}};
}

}  // namespace

FilterGatesCheck FilterGates() {
  return {.name = "filter_gates",
          .code = CodeHere(),
          .make = JudgeFiltered,
          .about = "whether images, wheels and gyro tell of the same motion"};
}

DeadReckoningStage DeadReckoning() {
  return {.name = "dead_reckoning",
          .about = "poses by wheels, gyro and inclinometer alone, with what is not known of them",
          .code = CodeHere(),
          .make = MakeDeadReckoned,
          .publishes = kTrajectoryOutputs,
          .publish = PublishDeadReckoned,
          .report = ReportDeadReckoned};
}

FilterStage Filter() {
  return {.name = "filter",
          .about = "poses by visual motion, wheels, gyro and inclinometer together",
          .code = CodeHere(),
          .make = MakeFiltered,
          .publishes = kTrajectoryOutputs,
          .publish = PublishFiltered,
          .report = ReportFiltered};
}

PosedPart PosedByRover(const StageContext& context, const Dataset& dataset,
                       const DeadReckonedPart& rover) {
  OdometricPart part = rover.part;
  for (TimedPose& pose : part.trajectory) {
    const Eigen::Vector3d stretch = rover.visual_scale_sigma * pose.world_from_left.translation;
    pose.position_covariance -= stretch * stretch.transpose();
    pose.sigmas.head<3>() = pose.position_covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  }
  return PosedByOdometry(context, dataset, part);
}

OdometricPart PartOfRover(const StageContext&, const DeadReckonedPart& rover) { return rover.part; }

Odometry StepsOfRover(const StageContext&, const DeadReckonedPart& rover) {
  Odometry steps;
  for (const TimedPose& pose : rover.part.trajectory) {
    const int before = std::max(0, static_cast<int>(steps.size()) - 1);
    steps.push_back({.stamp_ns = pose.stamp_ns,
                     .world_from_left = pose.world_from_left,
                     .reference = before,
                     .source = pose.source,
                     .keyframe = pose.keyframe});
  }
  return steps;
}

}  // namespace rigmap
