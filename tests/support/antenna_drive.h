// A drive as images see it, and the fixes of a receiver that rides along.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "pose_graph/fuse_fixes.h"
#include "scene/trajectory.h"

namespace rigmap {

inline const Eigen::Vector3d kAntenna(0.3, -1.0, -0.6);  // 1.2 m from the left camera

// A way of 40 m, turning by 120 degrees and back, a pose every 0.2 m and second; the camera looks
// along it. The images make it 0.3 % too long and turn a little too far at each step.
struct AntennaDrive {
  static constexpr double kScaleSigma = 0.005;  // as the images state it
  Trajectory truth, images;
  Rigid3 enu_from_world{Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ())),
                        {5.0, -3.0, 2.0}};

  AntennaDrive() {
    constexpr int kPoses = 200;
    constexpr double kScale = 1.003, kTurn_rad = 1e-5;
    Rigid3 pose, seen;
    for (int i = 0; i < kPoses; ++i) {
      truth.push_back(At(i, pose));
      images.push_back(At(i, seen));
      // Camera axes: z forward, x right, y down. Turning left about -y.
      // Left, then right: on one circle a clock that is off is nothing but a turn of the whole.
      const double turn = std::numbers::pi * (i < kPoses / 2 ? 4.0 : -4.0) / 3.0 / kPoses;
      const Rigid3 step{Eigen::Quaterniond(Eigen::AngleAxisd(-turn, Eigen::Vector3d::UnitY())),
                        {0.0, 0.0, 0.2}};
      Rigid3 off = step;
      off.translation *= kScale;
      off.rotation = off.rotation *
                     Eigen::Quaterniond(Eigen::AngleAxisd(-kTurn_rad, Eigen::Vector3d::UnitY()));
      pose = pose * step;
      seen = seen * off;
    }
  }

  static TimedPose At(int i, const Rigid3& world_level_from_left) {
    // Camera to a world with z up: x forward.
    Eigen::Matrix3d axes;
    axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    const Rigid3 world_from_first{Eigen::Quaterniond(axes), {0.0, 0.0, 1.0}};
    TimedPose pose{.stamp_ns = i * 1'000'000'000LL,
                   .world_from_left = world_from_first * world_level_from_left,
                   .source = PoseSource::kAdjusted};
    // By scale, and by headings that walk to a milliradian at the end.
    const Eigen::Vector3d way = world_level_from_left.translation;
    const double turned = 1e-3 * std::sqrt(i / 200.0),
                 aside_m = turned * way.norm() / std::sqrt(3.0);
    const Eigen::Vector3d along = axes * (kScaleSigma * way);
    pose.position_covariance =
        along * along.transpose() + aside_m * aside_m * Eigen::Matrix3d::Identity();
    pose.sigmas << pose.position_covariance.diagonal().cwiseSqrt(), turned, turned, turned;
    return pose;
  }

  // A fix every two seconds, 5 mm off in each axis; its clock ahead by so much.
  std::vector<AntennaFix> Fixes(double clock_s = 0.0) const {
    std::mt19937 random(3);
    std::normal_distribution<double> noise(0.0, 0.005);
    std::vector<AntennaFix> fixes;
    for (double time_s = 3.3; time_s < 195.0; time_s += 2.0) {
      const auto antenna = AntennaAt(truth, time_s, kAntenna, 3.0);
      const Eigen::Vector3d error(noise(random), noise(random), noise(random));
      fixes.push_back(
          {time_s + clock_s, enu_from_world * *antenna + error, Eigen::Vector3d::Constant(0.005)});
    }
    return fixes;
  }

  FixFusion Fusion() const { return {kAntenna, enu_from_world, kScaleSigma, std::nullopt, 3.0}; }

  // Root mean square distance of the antenna from its true places, both in ENU.
  double Error(const std::vector<Rigid3>& poses, const Rigid3& enu) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      sum += (enu * poses[i] * kAntenna - enu_from_world * truth[i].world_from_left * kAntenna)
                 .squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(poses.size()));
  }
  double ErrorOfImages() const {
    std::vector<Rigid3> poses;
    for (const TimedPose& pose : images) poses.push_back(pose.world_from_left);
    return Error(poses, enu_from_world);
  }
};

}  // namespace rigmap
