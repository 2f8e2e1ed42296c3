// Where an odometry has lost its way.
#pragma once

#include <vector>

#include "scene/odometry.h"

namespace rigmap {

// Predicted frames that only the frame before tells of, rising. Not those of runs that are held
// from both sides, whose end hangs on a frame before the run.
std::vector<int> LostFrames(const Odometry& odometry);

}  // namespace rigmap
