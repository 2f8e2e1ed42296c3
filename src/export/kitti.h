// KITTI trajectories: one pose per line, the 3 x 4 matrix world_from_body row by row, twelve
// numbers with one blank between and no stamp. Line i is line i of the TUM trajectory of the same
// poses.
#pragma once

#include <string>

#include "scene/trajectory.h"

namespace rigmap {

// The lines of world_from_left: metres with nine decimals, the rotation with twelve.
std::string WriteKitti(const Trajectory& trajectory);

}  // namespace rigmap
