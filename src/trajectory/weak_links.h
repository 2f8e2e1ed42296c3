// Where the odometry knows more of a motion than the adjustment.
#pragma once

#include <vector>

#include "scene/adjustment.h"
#include "scene/odometry.h"

namespace rigmap {

// Frames, rising, of which the adjustment ties those from them on to those before by so little (a
// few points on the horizon) that the odometric step tells their motion three times as well (root
// mean square of the three axes), though neither contradicts the other: as of all other frames that
// the odometry hangs across there. Where they do contradict each other, one is wrong, and neither
// says which.
std::vector<int> WeakLinks(const Odometry& odometry, const Adjustment& adjustment);

}  // namespace rigmap
