// How far the steps of a trajectory may be off, by what its poses say of themselves. Of this room
// only.
#pragma once

#include <vector>

#include "pose_graph/fuse_fixes.h"
#include "scene/trajectory.h"

namespace rigmap {

// Of a step, one sigma per axis. Never less than here, however sure poses are of themselves.
struct StepNoise {
  double metres = 1e-4, radians = 1e-5;
};

// Of the step to each pose: a random walk that grows to the sigmas of the least known measured
// pose, in each step by the share that `known` says. `scale_sigma` of the length is common to all
// steps and no part of it. A guess is known by as much less as it says than what was measured
// before it, and what lies behind it owes it that.
std::vector<StepNoise> NoisePerStep(const Trajectory& poses, const StepCovariances& known,
                                    double scale_sigma);

}  // namespace rigmap
