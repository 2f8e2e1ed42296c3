// Whether the wheels of a rover roll together as they do where images check them. Of this room
// only.
#pragma once

#include <vector>

#include "dead_reckoning/estimate_motion.h"

namespace rigmap {

// Frames that were asked about, rising.
struct WheelAgreement {
  std::vector<int> alike, unlike;
};

// Whether the six wheels turned to frames of which `asked` is set by shares of their mean that
// frames of which `checked` is set bear out; where not, they slip, each in its own way. A wheel's
// share depends on the curve; what it would be in a curve that no checked frame was driven in is
// not known, and such frames are in neither list, nor are those to which the rover hardly drove.
WheelAgreement AgreementOfWheels(const Dataset& dataset, const EstimatedMotion& motion,
                                 const std::vector<bool>& checked, const std::vector<bool>& asked,
                                 double wheel_radius_m);

}  // namespace rigmap
