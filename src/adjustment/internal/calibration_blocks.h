// What single stretches of a part, and single regions of the image, say of the rig's calibration.
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

struct CalibrationBlocks {
  std::vector<CalibrationBlock> stretches, regions;
};

// Stretches: points by the frame that saw them first, in eight of equally many posed frames, fewer
// of a part with fewer frames. Regions: by where the left image shows them on the average, in four
// rings about its principal point with equally many points, left and right halves of each; none
// without stretches. Weights are those of SolveCameraSystem; responses stand per frame.
CalibrationBlocks DivideCalibration(const std::vector<AdjustedPoint>& points,
                                    const std::vector<std::optional<Rigid3>>& left_from_world,
                                    const StereoRig& rig,
                                    const std::vector<PoseResponse>& responses, double noise_px,
                                    double huber_px);

}  // namespace rigmap
