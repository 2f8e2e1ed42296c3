// Where the poses of a part begin.
#pragma once

#include <optional>
#include <vector>

#include "scene/odometry.h"

namespace rigmap {

// The first frame that is posed by what it shows; all other poses are relative to it. Poses before
// it are guesses, so the world does not start there.
int FirstPosedFrame(const Odometry& odometry);

// Starting poses of all frames for the adjustment, in one gauge. A keyframe's is the mapped one if
// there is one (`mapped` per frame; may be empty), that of any other frame follows from its
// reference frame by the odometry. Frames that stand still, were predicted or come before the first
// posed one get none: they have nothing to adjust.
std::vector<std::optional<Rigid3>> StartingPoses(const Odometry& odometry,
                                                 const std::vector<std::optional<Rigid3>>& mapped);

}  // namespace rigmap
