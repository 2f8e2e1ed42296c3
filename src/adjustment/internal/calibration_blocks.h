// What single stretches of a part, and single regions of the image, say of the rig's calibration.
#pragma once

#include <optional>
#include <vector>

#include "adjustment/internal/reduced_system.h"
#include "scene/adjustment.h"

namespace rigmap {

// How an adjusted pose follows: the perturbation of left_from_world (rotation, translation) that
// the normal equations ask for, and its derivative by the calibration. Zero for held frames. The
// same of the right eye's turn in the frame, zero without flexure.
struct PoseResponse {
  Vector6d step = Vector6d::Zero();
  Eigen::Matrix<double, 6, kCalibrationSize> by_calibration =
      Eigen::Matrix<double, 6, kCalibrationSize>::Zero();
  Eigen::Vector3d turn_step = Eigen::Vector3d::Zero();
  Eigen::Matrix<double, 3, kCalibrationSize> turn_by_calibration =
      Eigen::Matrix<double, 3, kCalibrationSize>::Zero();
};

// How the field of a lens does, a row for each of its parameters.
struct FieldResponse {
  Eigen::VectorXd step;
  Eigen::Matrix<double, Eigen::Dynamic, kCalibrationSize> by_calibration;
};

struct CalibrationBlocks {
  std::vector<CalibrationBlock> stretches, regions;
  // Of the sum of their scores, when residuals of a point go together as they will.
  CalibrationMatrix score_covariance = CalibrationMatrix::Zero();
};

// Per point: of so many stretches with equally many posed frames, that of the frame that saw it
// first.
std::vector<int> StretchesOf(const Linearisation& at, int stretches);
// As many as can contradict each other, as far as there are frames for so many.
int StretchCount(const Linearisation& at);

// Stretches: points by the frame that saw them first, in eight of equally many posed frames, fewer
// of a part with fewer frames. Regions: by where the left image shows them on the average, in four
// rings about its principal point with equally many points, left and right halves of each; none
// without stretches. Poses (per frame) and the field, if there is one, follow.
CalibrationBlocks DivideCalibration(const Linearisation& at, const std::vector<PoseResponse>& poses,
                                    const FieldResponse& field);

}  // namespace rigmap
