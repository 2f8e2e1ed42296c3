// Poses over time.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <string_view>
#include <vector>

#include "core/stamp.h"
#include "geometry/serialize.h"

namespace rigmap {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

// How a pose was got: from the adjustment, from odometry alone, or predicted from the motion.
enum class PoseSource { kAdjusted = 0, kOdometry = 1, kPredicted = 2 };

constexpr std::string_view Name(PoseSource source) {
  return source == PoseSource::kAdjusted   ? "adjusted"
         : source == PoseSource::kOdometry ? "odometry"
                                           : "predicted";
}

struct TimedPose {
  StampNs stamp_ns = 0;
  Rigid3 world_from_left;
  // One standard deviation relative to the first posed frame, along and about the world axes:
  // x y z in metres, then rotations about x y z in radians.
  Vector6d sigmas = Vector6d::Zero();
  Eigen::Matrix3d position_covariance = Eigen::Matrix3d::Zero();  // m^2, the same with correlations
  PoseSource source = PoseSource::kPredicted;
  bool keyframe = false;

  bool IsMeasured() const { return source != PoseSource::kPredicted; }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(stamp_ns, world_from_left, sigmas, position_covariance, source, keyframe);
  }
};

using Trajectory = std::vector<TimedPose>;  // strictly increasing stamps

// Index of the first measured pose, which sigmas are relative to; 0 where none is.
inline std::size_t FirstMeasured(const Trajectory& trajectory) {
  const auto first = std::ranges::find_if(trajectory, &TimedPose::IsMeasured);
  return first == trajectory.end() ? 0 : static_cast<std::size_t>(first - trajectory.begin());
}

}  // namespace rigmap
