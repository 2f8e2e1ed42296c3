// How a pose is written in every text file of this project.
#pragma once

#include <string>

#include "geometry/rigid3.h"

namespace rigmap {

// "tx ty tz qx qy qz qw" with `separator` between: metres with nine decimals, the unit quaternion
// with twelve and qw >= 0. Reads back to 1e-9 m and 1e-12.
std::string FormatPose(const Rigid3& world_from_body, char separator);

}  // namespace rigmap
