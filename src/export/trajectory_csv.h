// The trajectory with all that is known about each pose, for spreadsheets and scripts.
#pragma once

#include <string>

#include "scene/trajectory.h"

namespace rigmap {

// A header line, then one line per pose:
//   stamp_ns                  integer, UTC
//   tx,ty,tz,qx,qy,qz,qw      world_from_left, metres and unit quaternion, as in the TUM file
//   sx,sy,sz,srx,sry,srz      one standard deviation along and about the world axes, metres and
//                             radians, relative to the first posed frame
//   source                    adjusted, odometry or predicted
//   keyframe                  1 or 0
std::string WriteTrajectoryCsv(const Trajectory& trajectory);

}  // namespace rigmap
