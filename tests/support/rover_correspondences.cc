#include "tests/support/rover_correspondences.h"

#include <algorithm>

namespace rigmap {

Correspondences RoverCorrespondences(const SyntheticRover& rover, int max_frames_apart) {
  Correspondences correspondences;
  const int frames = static_cast<int>(rover.frames.size());
  for (const FrameFeatures& frame : rover.frames) {
    correspondences.features.push_back(frame.features);
  }
  for (int a = 0; a < frames; ++a) {
    for (int b = a + 1; b < std::min(frames, a + max_frames_apart + 1); ++b) {
      FramePair pair{a, b, {}};
      for (const auto& [of_a, of_b] : TrueMatches(rover, a, b)) {
        pair.matches.emplace_back(of_a, of_b);
      }
      correspondences.pairs.push_back(std::move(pair));
    }
  }
  return correspondences;
}

std::vector<Rigid3> DriftingPoses(const SyntheticRover& rover, double step_sigma_m,
                                  double step_sigma_rad, SeededRandom& random) {
  std::vector<Rigid3> poses{rover.world_from_left.front()};
  for (std::size_t i = 1; i < rover.world_from_left.size(); ++i) {
    const Rigid3 step = rover.world_from_left[i - 1].Inverse() * rover.world_from_left[i];
    const Eigen::Vector3d turn = random.Noise(step_sigma_rad);
    const Rigid3 error{ExpRotation(turn), random.Noise(step_sigma_m)};
    poses.push_back(poses.back() * step * error);
  }
  return poses;
}

Odometry OdometryOfKeyframes(const SyntheticRover& rover, const std::vector<Rigid3>& poses) {
  Odometry odometry;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    OdometryFrame frame;
    frame.stamp_ns = rover.frames[i].stamp_ns;
    frame.world_from_left = poses[i];
    frame.reference = i == 0 ? 0 : static_cast<int>(i) - 1;
    frame.source = PoseSource::kOdometry;
    frame.keyframe = true;
    odometry.push_back(frame);
  }
  return odometry;
}

}  // namespace rigmap
