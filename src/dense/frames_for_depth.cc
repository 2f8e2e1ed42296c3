#include "dense/frames_for_depth.h"

#include <algorithm>
#include <limits>

#include "core/statistics.h"

namespace rigmap {
namespace {

constexpr double kFastest = 0.9;  // quantile of the points' shifts

// What a keyframe shows, seen from wherever.
class PassingPoints {
 public:
  PassingPoints(const Camera& camera, const std::vector<Eigen::Vector3d>& x_in_left,
                const Rigid3& world_from_left)
      : camera_(camera) {
    for (const Eigen::Vector3d& x : x_in_left) in_world_.push_back(world_from_left * x);
  }

  // Whether too much passes between two views.
  bool PassTooFast(const Rigid3& world_from_one, const Rigid3& world_from_other) const {
    const Rigid3 one = world_from_one.Inverse(), other = world_from_other.Inverse();
    std::vector<double> shifts_px;
    for (const Eigen::Vector3d& x : in_world_) {
      const auto here = Project(camera_, one * x);
      if (!here || !camera_.Contains(*here)) continue;
      const auto there = Project(camera_, other * x);
      shifts_px.push_back(there ? (*there - *here).norm()
                                : std::numeric_limits<double>::infinity());
    }
    const double most_px = std::min(camera_.width, camera_.height) / kViewsOfFastest;
    return shifts_px.empty() || Quantile(std::move(shifts_px), kFastest) > most_px;
  }

 private:
  const Camera& camera_;
  std::vector<Eigen::Vector3d> in_world_;
};

// Whether a pose is known relative to another so well that a map of such voxels does not show it.
bool IsKnownBeside(const TimedPose& pose, const TimedPose& other, double near_m, double voxel_m) {
  const Vector6d more = (pose.sigmas.cwiseAbs2() - other.sigmas.cwiseAbs2()).cwiseMax(0.0);
  const double square_m2 = more.head<3>().maxCoeff() + near_m * near_m * more.tail<3>().maxCoeff();
  return square_m2 < voxel_m * voxel_m;  // false for one that is not a number
}

bool IsSure(const TimedPose& pose, double voxel_m) {
  return pose.source == PoseSource::kAdjusted ||
         (pose.source == PoseSource::kOdometry && pose.sigmas.head<3>().maxCoeff() < voxel_m);
}

}  // namespace

std::vector<int> FramesForDepth(const PosedFrames& frames, double near_m, double voxel_m) {
  const Trajectory& trajectory = frames.trajectory;
  const bool all = std::ranges::count(trajectory, true, &TimedPose::keyframe) < kFewKeyframes;
  const auto is_readable = [&](int frame) {
    return !std::ranges::binary_search(frames.unreadable, frame);
  };
  const int count = static_cast<int>(trajectory.size());
  std::vector<int> keyframes;
  for (int i = 0; i < count; ++i) {
    const TimedPose& pose = trajectory[i];
    if (IsSure(pose, voxel_m) && is_readable(i) && (all || pose.keyframe)) keyframes.push_back(i);
  }
  if (all) return keyframes;
  std::vector<int> chosen;
  for (std::size_t k = 0; k < keyframes.size(); ++k) {
    const TimedPose& keyframe = trajectory[keyframes[k]];
    const PassingPoints points(frames.camera, frames.points_in_left[keyframes[k]],
                               keyframe.world_from_left);
    chosen.push_back(keyframes[k]);
    const int end = k + 1 < keyframes.size() ? keyframes[k + 1] : count;
    for (int i = keyframes[k] + 1; i < end; ++i) {
      const bool may = trajectory[i].IsMeasured() && is_readable(i) &&
                       IsKnownBeside(trajectory[i], keyframe, near_m, voxel_m);
      if (may && (i + 1 == count || points.PassTooFast(trajectory[chosen.back()].world_from_left,
                                                       trajectory[i + 1].world_from_left))) {
        chosen.push_back(i);
      }
    }
  }
  return chosen;
}

}  // namespace rigmap
