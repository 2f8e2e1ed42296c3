// What a part's images say of its rig's calibration.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "core/enum_names.h"
#include "geometry/serialize.h"

namespace rigmap {

// Parameters of a correction of a stereo rig, in this order: the right eye's rotation about its own
// centre (rad, right camera axes), so that the baseline's length stays; the logarithm of a factor
// on all focal lengths, and of another on the right eye's; that of a factor on fy of both eyes (fx
// is where the metres come from), and of another on the right eye's; principal points (px); of both
// eyes k1, k2, p1 and p2 of OpenCV's distortion model.
enum CalibrationParameter {
  kRotationX,
  kRotationY,
  kRotationZ,
  kLogFocal,
  kLogRightFocal,
  kLogAspect,
  kLogRightAspect,
  kLeftCx,
  kLeftCy,
  kRightCx,
  kRightCy,
  kLeftK1,
  kLeftK2,
  kLeftP1,
  kLeftP2,
  kRightK1,
  kRightK2,
  kRightP1,
  kRightP2,
  kCalibrationSize
};
using CalibrationVector = Eigen::Matrix<double, kCalibrationSize, 1>;
using CalibrationMatrix = Eigen::Matrix<double, kCalibrationSize, kCalibrationSize>;
// By how much each parameter moves a pose.
using PoseCalibration = Eigen::Matrix<double, 6, kCalibrationSize>;

// How far the calibration in a rig file may be off before any image of a part has been seen; no
// correction is the most probable one.
struct CalibrationPrior {
  CalibrationVector sigmas = CalibrationVector::Ones();
  CalibrationMatrix information = CalibrationMatrix::Identity();
};

// Which parameters an adjustment corrects. kAuto: as many as the images tell.
enum class RigRefinement { kNone, kRotation, kRotationAndFocal, kAllButFocal, kAll, kAuto };
constexpr auto NamesOf(RigRefinement) {
  return std::array{"none", "rotation", "rotation+focal", "all-but-focal", "all", "auto"};
}

// What a stretch of a part, or a region of the image, says of the calibration, the poses of the
// whole part following it.
struct CalibrationBlock {
  CalibrationVector score = CalibrationVector::Zero();
  CalibrationMatrix information = CalibrationMatrix::Zero();

  CalibrationBlock& operator+=(const CalibrationBlock& other) {
    score += other.score;
    information += other.information;
    return *this;
  }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(score, information);
  }
};

// The normal equations of the adjustment once poses and points are eliminated, at the calibration
// that was held: the free step x would solve information x = score.
struct CalibrationEquations {
  CalibrationVector score = CalibrationVector::Zero();
  CalibrationMatrix information = CalibrationMatrix::Zero();  // as if observations were independent
  // Of the score, residuals of one track going together as they will.
  CalibrationMatrix score_covariance = CalibrationMatrix::Zero();
  // What all windows have in common adds to the score's covariance, in units of the information: it
  // does not become less with their number.
  double coherent = 0.0;
  // Score and information by stretches of about equally many frames, in order, and by regions of
  // the image: the sums of either, with what the prior of a field of the lens says that follows the
  // calibration, are those of the whole.
  std::vector<CalibrationBlock> stretches, regions;
  CalibrationBlock of_field;  // zero without a field

  bool HasField() const { return !of_field.information.isZero(); }
  // Score and information from those of stretches and field.
  void AddUp() {
    CalibrationBlock sum = of_field;
    for (const CalibrationBlock& stretch : stretches) sum += stretch;
    score = sum.score;
    information = sum.information;
  }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(score, information, score_covariance, coherent, stretches, regions, of_field);
  }
};

}  // namespace rigmap
