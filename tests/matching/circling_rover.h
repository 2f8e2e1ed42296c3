// A rover that comes back to where it was, and what is matched of it.
#pragma once

#include <cmath>
#include <numbers>

#include "matching/match_frames.h"
#include "tests/support/rover_correspondences.h"
#include "tests/support/synthetic_rover.h"

namespace rigmap {

// Once round a circle and a little further.
inline SyntheticRover CircleAndOn() {
  std::vector<Rigid3> path;
  for (int i = 0; i < 23; ++i) {
    const double heading = 2.0 * std::numbers::pi * i / 20;
    path.push_back(RoverPose(2.0 * std::sin(heading), 2.0 * (1.0 - std::cos(heading)), heading));
  }
  return MakeSyntheticRover({.points_per_m2 = 12.0, .pixel_sigma = 0.2, .textured_patches = true},
                            path);
}

// Every step a degree too far to the left: 20 degrees at the end, far beyond any search radius.
inline Odometry Drifting(const SyntheticRover& rover) {
  std::vector<Rigid3> poses{rover.world_from_left.front()};
  for (std::size_t i = 1; i < rover.world_from_left.size(); ++i) {
    const Rigid3 step = rover.world_from_left[i - 1].Inverse() * rover.world_from_left[i];
    const Rigid3 turn{ExpRotation({0.0, -std::numbers::pi / 180.0, 0.0}), Eigen::Vector3d::Zero()};
    poses.push_back(poses.back() * step * turn);
  }
  return OdometryOfKeyframes(rover, poses);
}

inline Correspondences MatchRover(const SyntheticRover& rover, const Odometry& odometry,
                                  const MatchingOptions& options = {}) {
  return MatchFrames(
      odometry, [&](int frame) { return rover.frames[frame]; }, rover.rig, options);
}

inline Rigid3 TrueMotion(const SyntheticRover& rover, const LoopClosure& loop_closure) {
  return rover.world_from_left[loop_closure.b].Inverse() * rover.world_from_left[loop_closure.a];
}

}  // namespace rigmap
