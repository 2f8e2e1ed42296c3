// What the images of a part say of the rig's calibration, and where they would move it.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "adjustment/adjustment_options.h"
#include "geometry/serialize.h"
#include "scene/rig.h"

namespace rigmap {

// Parameters of a correction, in this order: the right eye's rotation about its own centre (rad,
// right camera axes), so that the baseline's length stays; the logarithm of a factor on all focal
// lengths, and of another on the right eye's; principal points (px); k1 of both eyes.
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

StereoRig Corrected(const StereoRig& rig, const CalibrationVector& correction);

// The normal equations of the adjustment once poses and points are eliminated, at the calibration
// that was held: the free step x would solve information x = score.
struct CalibrationEquations {
  CalibrationVector score = CalibrationVector::Zero();
  CalibrationMatrix information = CalibrationMatrix::Zero();  // as if observations were independent
  // Of the score, residuals of one track going together as they will (ScoreClusters).
  CalibrationMatrix score_covariance = CalibrationMatrix::Zero();

  template <class Archive>
  void serialize(Archive& archive) {
    archive(score, information, score_covariance);
  }
};

// The step that rotation and common focal factor would take together, all else held. Its sigmas are
// grown as those of poses are, because residuals of one track go together; so does what a wrong rig
// leaves over. How well the path could determine them at all, the sigmas of independent residuals
// say.
struct CalibrationStep {
  Eigen::Vector3d rig_rotation, rig_rotation_sigma, rig_rotation_sigma_if_independent;
  double log_focal, log_focal_sigma, log_focal_sigma_if_independent;
};

// Nothing where the equations are singular.
std::optional<CalibrationStep> RotationAndFocalStep(const CalibrationEquations& equations);

// In sigmas of the prior.
CalibrationVector InPriorSigmas(const CalibrationVector& correction,
                                const AdjustmentOptions& options);

struct ProbableCorrection {
  CalibrationVector correction;
  CalibrationMatrix covariance;
};

// The correction that is most probable under the prior, given what the part says at the correction
// `now`; nothing if refine_rig asks for none or ("auto", at no correction) if no parameter by
// itself contradicts the calibration by more than refine_sigmas.
std::optional<ProbableCorrection> BetterCorrection(const CalibrationVector& now,
                                                   const CalibrationEquations& equations,
                                                   const AdjustmentOptions& options);

}  // namespace rigmap
