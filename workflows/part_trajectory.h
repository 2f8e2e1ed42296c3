// A pose with a sigma for every frame, whatever is known of it.
#pragma once

#include <vector>

#include "adjustment/adjust.h"
#include "adjustment/level_world.h"
#include "scene/odometry.h"
#include "scene/trajectory.h"

namespace rigmap {

// The first frame that is posed by what it shows: all others hang on it. The guesses before it are
// no place to start a world from.
int FirstPosedFrame(const Odometry& odometry);

// Starting poses of all frames for the adjustment, in one gauge. A keyframe's is the mapped one if
// there is one (`mapped` per frame; may be empty), any other frame hangs on its reference by the
// odometry. Frames that stand still, were predicted or come before the first posed one get none:
// they have nothing to adjust.
std::vector<std::optional<Rigid3>> StartingPoses(const Odometry& odometry,
                                                 const std::vector<std::optional<Rigid3>>& mapped);

// The adjusted pose where there is one; else the odometric step from the frame's reference, so that
// a frame that stands still stands where its reference does. A run of predicted frames between two
// others is moved onto both ends, in proportion to time. Sigmas add up along the steps; inside a
// run they are those of both ends together. All are relative to the first posed frame.
Trajectory AssembleTrajectory(const Odometry& odometry, const Adjustment& adjustment,
                              const Rigid3& world_from_gauge);

}  // namespace rigmap
