// Whether the wheels of a rover roll together as they do where images check them. Of this room
// only.
#pragma once

#include <vector>

#include "dead_reckoning/estimate_motion.h"

namespace rigmap {

// Frames of which `asked` is set and to which the six wheels turned by shares of their mean that
// frames of which `checked` is set do not bear out: they slip, each in its own way. A wheel's share
// depends on the curve; what it would be in a curve that no checked frame was driven in is not
// known, and nothing is found there. Frames to which the rover hardly drove are left out.
std::vector<int> FramesOfUnlikeWheels(const Dataset& dataset, const EstimatedMotion& motion,
                                      const std::vector<bool>& checked,
                                      const std::vector<bool>& asked, double wheel_radius_m);

}  // namespace rigmap
