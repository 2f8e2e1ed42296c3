#include "adjustment/unchecked_scale.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "adjustment/calibration_prior.h"
#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

// By hand, from the turn about y and the principal points alone.
TEST(UncheckedScaleSigma, IsThatOfAnOffsetOfAllDisparitiesAndOfTheFocalLength) {
  const StereoRig rig = LocCamRig();
  AdjustmentOptions options;
  const double f = rig.left.camera.fx;
  const double turn_px = options.rig_prior_deg * std::numbers::pi / 180.0 * f;
  const double offset_px = std::hypot(turn_px, std::sqrt(2.0) * options.principal_point_prior_px);
  const double disparity_px = f * rig.Baseline() / 4.0;
  const double expected = std::hypot(offset_px / disparity_px, 0.01 * options.focal_prior_pct);
  EXPECT_NEAR(UncheckedScaleSigma(rig, {2.0, 4.0, 9.0}, options), expected, 0.15 * expected);
  // Twice as near, the offset matters half as much.
  options.focal_prior_pct = 1e-6;
  EXPECT_NEAR(UncheckedScaleSigma(rig, {2.0}, options) / UncheckedScaleSigma(rig, {4.0}, options),
              0.5, 1e-3);
  EXPECT_EQ(UncheckedScaleSigma(rig, {}, options), 0.0);
}

TEST(UncheckedScaleSigma, IsSmallWhereTheRigFileKnowsItsCalibration) {
  StereoRig rig = LocCamRig();
  const AdjustmentOptions options;
  const double by_prior = UncheckedScaleSigma(rig, {4.0}, options);
  rig.calibration_covariance = 0.01 * PriorOf(rig, options).information.inverse();
  EXPECT_NEAR(UncheckedScaleSigma(rig, {4.0}, options), 0.1 * by_prior, 0.01 * by_prior);
}

TEST(UncheckedFocalSigma, IsWhatThePriorOrTheRigFileSays) {
  StereoRig rig = LocCamRig();
  EXPECT_NEAR(UncheckedFocalSigma(rig, {.focal_prior_pct = 0.7}), 0.007, 1e-9);
  rig.calibration_covariance = 1e-6 * CalibrationMatrix::Identity();
  EXPECT_NEAR(UncheckedFocalSigma(rig, {}), 0.001, 1e-12);
}

}  // namespace
}  // namespace rigmap
