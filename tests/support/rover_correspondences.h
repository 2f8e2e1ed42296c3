// The synthetic rover as the stages behind the matching see it.
#pragma once

#include <vector>

#include "scene/correspondences.h"
#include "scene/odometry.h"
#include "tests/support/seeded_random.h"
#include "tests/support/synthetic_rover.h"

namespace rigmap {

// All true matches between frames up to `max_frames_apart`, all features.
Correspondences RoverCorrespondences(const SyntheticRover& rover, int max_frames_apart);

// world_from_left as an odometry finds it that errs by these sigmas (each axis) at every step,
// starting at the truth.
std::vector<Rigid3> DriftingPoses(const SyntheticRover& rover, double step_sigma_m,
                                  double step_sigma_rad, SeededRandom& random);

// Every frame a keyframe, posed as given.
Odometry OdometryOfKeyframes(const SyntheticRover& rover, const std::vector<Rigid3>& poses);

}  // namespace rigmap
