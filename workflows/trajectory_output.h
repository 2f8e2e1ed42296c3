// The trajectory as users read it.
#pragma once

#include <filesystem>

#include "scene/rig.h"
#include "scene/trajectory.h"

namespace rigmap {

// trajectory.csv, trajectory_midpoint.tum, trajectory_antenna.tum (where the rig knows its antenna)
// and, last, trajectory.tum.
void WriteTrajectoryOutput(const StereoRig& rig, const Trajectory& trajectory,
                           const std::filesystem::path& folder);

}  // namespace rigmap
