// A pose with a sigma for every frame, whatever is known of it.
#pragma once

#include <vector>

#include "scene/adjustment.h"
#include "scene/odometry.h"
#include "scene/trajectory.h"

namespace rigmap {

// The adjusted pose where there is one; else the odometric step from the frame's reference, so that
// a frame that stands still stands where its reference does. A run of predicted frames between two
// others is moved, in proportion to time, by how far its end lies from where the odometry's own
// step put it. Sigmas add up along the steps; inside a run they are those of both ends together.
// All are relative to the first posed frame, and not a number where the adjustment knows no
// covariances.
Trajectory AssembleTrajectory(const Odometry& odometry, const Adjustment& adjustment,
                              const Rigid3& world_from_gauge);

}  // namespace rigmap
