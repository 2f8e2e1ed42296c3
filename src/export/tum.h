// TUM trajectories: one pose per line, "t tx ty tz qx qy qz qw". t is in seconds, the rest is
// world_from_body: position of the body in metres, its axes as a unit quaternion. '#' starts a
// comment line.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scene/trajectory.h"

namespace rigmap {

struct TumPose {
  StampNs stamp_ns = 0;
  Rigid3 world_from_body;
};

// The lines of a body that is fixed in the left camera, which it is if nothing is said (else the
// antenna, the middle of the rig): stamps with nine decimals; no comment, so that equal
// trajectories give equal bytes. Reads back to 1e-9 m and 1e-12 of the quaternion.
std::string WriteTum(const Trajectory& trajectory, const Rigid3& left_from_body = {});

// The poses in order of time. Fields stand apart by spaces, tabs or commas; quaternions within 1e-2
// of unit length are normalised. Throws DataError naming file and line for anything else, and for a
// file without a pose.
std::vector<TumPose> ReadTum(const std::filesystem::path& path);

}  // namespace rigmap
