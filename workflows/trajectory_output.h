// The trajectory, and the rig where it was corrected, as users read them.
#pragma once

#include <filesystem>

#include "scene/rig.h"
#include "scene/trajectory.h"

namespace rigmap {

// trajectory.csv, trajectory_midpoint.tum, trajectory_antenna.tum (where the rig knows its antenna)
// and, last, trajectory.tum.
void WriteTrajectoryOutput(const StereoRig& rig, const Trajectory& trajectory,
                           const std::filesystem::path& folder);

// The rig that the part corrected, as a rig file that says so.
void WriteRigOutput(const StereoRig& rig, const std::filesystem::path& file);

}  // namespace rigmap
