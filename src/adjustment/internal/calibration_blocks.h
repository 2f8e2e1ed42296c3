// What single stretches of a part say of the rig's calibration.
#pragma once

#include <optional>
#include <vector>

#include "scene/adjustment.h"

namespace rigmap {

// How an adjusted pose follows: the perturbation of left_from_world (rotation, translation) that
// the normal equations ask for, and its derivative by the calibration. Zero for held frames.
struct PoseResponse {
  Vector6d step = Vector6d::Zero();
  Eigen::Matrix<double, 6, kCalibrationSize> by_calibration =
      Eigen::Matrix<double, 6, kCalibrationSize>::Zero();
};

// Points by the frame that saw them first, in eight stretches of equally many posed frames, fewer
// of a part with fewer frames. Weights are those of SolveCameraSystem; responses stand per frame.
std::vector<CalibrationBlock> CalibrationBlocks(
    const std::vector<AdjustedPoint>& points,
    const std::vector<std::optional<Rigid3>>& left_from_world, const StereoRig& rig,
    const std::vector<PoseResponse>& responses, double noise_px, double huber_px);

}  // namespace rigmap
