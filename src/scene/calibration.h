// What a part's images say of its rig's calibration.
#pragma once

#include <Eigen/Core>

#include "geometry/serialize.h"

namespace rigmap {

// Parameters of a correction of a stereo rig, in this order: the right eye's rotation about its own
// centre (rad, right camera axes), so that the baseline's length stays; the logarithm of a factor
// on all focal lengths, and of another on the right eye's; principal points (px); k1 of both eyes.
enum CalibrationParameter {
  kRotationX,
  kRotationY,
  kRotationZ,
  kLogFocal,
  kLogRightFocal,
  kLeftCx,
  kLeftCy,
  kRightCx,
  kRightCy,
  kLeftK1,
  kRightK1,
  kCalibrationSize
};
using CalibrationVector = Eigen::Matrix<double, kCalibrationSize, 1>;
using CalibrationMatrix = Eigen::Matrix<double, kCalibrationSize, kCalibrationSize>;

// The normal equations of the adjustment once poses and points are eliminated, at the calibration
// that was held: the free step x would solve information x = score.
struct CalibrationEquations {
  CalibrationVector score = CalibrationVector::Zero();
  CalibrationMatrix information = CalibrationMatrix::Zero();  // as if observations were independent
  // Of the score, residuals of one track going together as they will.
  CalibrationMatrix score_covariance = CalibrationMatrix::Zero();

  template <class Archive>
  void serialize(Archive& archive) {
    archive(score, information, score_covariance);
  }
};

}  // namespace rigmap
