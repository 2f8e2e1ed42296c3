#include "adjustment/unchecked_scale.h"

#include <spdlog/spdlog.h>

#include <Eigen/LU>
#include <cmath>

#include "adjustment/calibration.h"
#include "adjustment/calibration_prior.h"

namespace rigmap {
namespace {

// Per metre of path: of the steps by which keyframes hang on each other.
OffsetEffect OffsetOfPath(const Odometry& motion) {
  OffsetEffect sum;
  double path_m = 0.0;
  for (std::size_t i = 0; i < motion.size(); ++i) {
    const OdometryFrame& frame = motion[i];
    if (frame.stands_still || (!frame.keyframe && i + 1 < motion.size())) continue;
    const Rigid3 step = OdometricStep(motion, frame.reference, static_cast<int>(i));
    path_m += step.translation.norm();
    sum.lengthening_m_per_px += frame.offset.lengthening_m_per_px;
    sum.score += frame.offset.score;
    sum.information += frame.offset.information;
  }
  if (path_m > 0.0) sum.lengthening_m_per_px /= path_m;
  return sum;
}

}  // namespace

UncheckedScale UncheckedScaleOf(const StereoRig& rig, const Odometry& motion,
                                const AdjustmentOptions& options) {
  const CalibrationPrior prior = PriorOf(rig, options);
  const CalibrationMatrix covariance = prior.information.inverse();
  const double prior_px =
      SigmaOf(DisparityAtInfinity, rig, CalibrationVector::Zero(), prior.sigmas, covariance);
  const OffsetEffect path = OffsetOfPath(motion);
  const double inflation = options.shared_noise * options.shared_noise;
  const double asked_px =
      path.score / inflation / (path.information / inflation + 1.0 / (prior_px * prior_px));
  spdlog::info(
      "an offset of disparities: {:.3f} px asked for, of which each moves lengths by {:.2f} %",
      asked_px, 100.0 * path.lengthening_m_per_px);
  return {std::hypot(std::hypot(prior_px, asked_px) * path.lengthening_m_per_px,
                     std::sqrt(covariance(kLogFocal, kLogFocal))),
          asked_px};
}

double UncheckedFocalSigma(const StereoRig& rig, const AdjustmentOptions& options) {
  return PriorOf(rig, options).sigmas(kLogFocal);
}

}  // namespace rigmap
