#include "trajectory/starting_poses.h"

namespace rigmap {

int FirstPosedFrame(const Odometry& odometry) {
  int first = 0;
  while (odometry[first].reference != first) ++first;
  return first;
}

std::vector<std::optional<Rigid3>> StartingPoses(const Odometry& odometry,
                                                 const std::vector<std::optional<Rigid3>>& mapped) {
  std::vector<Rigid3> poses(odometry.size());
  std::vector<std::optional<Rigid3>> starting(odometry.size());
  const int first = FirstPosedFrame(odometry), count = static_cast<int>(odometry.size());
  for (int i = first; i < count; ++i) {
    const OdometryFrame& frame = odometry[i];
    poses[i] = frame.world_from_left;
    if (i < static_cast<int>(mapped.size()) && mapped[i]) {
      poses[i] = *mapped[i];
    } else if (frame.reference != i) {
      poses[i] = poses[frame.reference] * OdometricStep(odometry, frame.reference, i);
    }
    const bool measured = frame.source == PoseSource::kOdometry && !frame.stands_still;
    if (measured || frame.keyframe) starting[i] = poses[i];
  }
  return starting;
}

}  // namespace rigmap
