#include "adjustment/unchecked_scale.h"

#include <Eigen/LU>
#include <cmath>

#include "adjustment/calibration.h"
#include "adjustment/calibration_prior.h"
#include "core/statistics.h"

namespace rigmap {

double UncheckedScaleSigma(const StereoRig& rig, std::vector<double> depths_m,
                           const AdjustmentOptions& options) {
  if (depths_m.empty()) return 0.0;
  const CalibrationPrior prior = PriorOf(rig, options);
  const CalibrationMatrix covariance = prior.information.inverse();
  const double offset_px =
      SigmaOf(DisparityAtInfinity, rig, CalibrationVector::Zero(), prior.sigmas, covariance);
  const double disparity_px = rig.left.camera.fx * rig.Baseline() / Median(std::move(depths_m));
  return std::hypot(offset_px / disparity_px, std::sqrt(covariance(kLogFocal, kLogFocal)));
}

double UncheckedFocalSigma(const StereoRig& rig, const AdjustmentOptions& options) {
  return PriorOf(rig, options).sigmas(kLogFocal);
}

}  // namespace rigmap
