// Where the images of a part would move the rig's calibration.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "adjustment/adjustment_options.h"
#include "scene/calibration.h"
#include "scene/rig.h"

namespace rigmap {

StereoRig Corrected(const StereoRig& rig, const CalibrationVector& correction);

// The step that rotation and common focal factor would take together, all else held. Its sigmas are
// inflated as those of poses are, because residuals of one track are correlated; errors that a
// wrong rig leaves in the residuals are correlated as well. How well the path could determine the
// step at all, the sigmas of independent residuals say.
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
