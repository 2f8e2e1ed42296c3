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

// Whether the six wheels turned to frames of which `asked` is set as frames of which `checked` is
// set bear out; where not, they slip, each in its own way. How far a wheel turns, as a share of the
// middle axle, follows from the way, the turn (by the gyro) and its steering angle; what differs
// from wheel to wheel (radius, lasting slip, place on the rover) is estimated from the checked
// frames. Where these leave open how far wheels would turn if none slipped, as in a curve of which
// no other was driven, or the rover hardly drove, a frame is in neither list.
WheelAgreement AgreementOfWheels(const Dataset& dataset, const EstimatedMotion& motion,
                                 const std::vector<bool>& checked, const std::vector<bool>& asked,
                                 double wheel_radius_m);

}  // namespace rigmap
