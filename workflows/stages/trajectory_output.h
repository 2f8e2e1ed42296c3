// The trajectory, and the rig where it was corrected, as users read them.
#pragma once

#include <string>
#include <vector>

#include "pipeline/stage.h"
#include "scene/rig.h"
#include "scene/trajectory.h"

namespace rigmap {

inline const std::vector<std::string> kTrajectoryOutputs{
    "trajectory.tum", "trajectory_kitti.txt", "trajectory.csv", "trajectory_midpoint.tum",
    "trajectory_antenna.tum"};

// trajectory.csv, trajectory_midpoint.tum, trajectory_antenna.tum (where the rig knows its
// antenna), trajectory_kitti.txt and, last, trajectory.tum.
void PublishTrajectory(const StereoRig& rig, const Trajectory& trajectory,
                       Publication& publication);

// rig_refined.yaml: the rig that the part corrected, as a rig file that says so.
void PublishRig(const StereoRig& rig, Publication& publication);

}  // namespace rigmap
