#include "adjustment/unchecked_scale.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "adjustment/calibration_prior.h"
#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

constexpr double kSteps = 10.0, kStep_m = 0.2;

// Of steps straight ahead, each from a keyframe to the next; the offset lengthens a metre of them
// by so much, and 1 / px^2 of each say what it is.
Odometry Drive(double longer_per_px, double offset_px, double information) {
  Odometry motion(1, {.source = PoseSource::kOdometry, .keyframe = true});
  for (int i = 1; i <= static_cast<int>(kSteps); ++i) {
    motion.push_back({.world_from_left = {Eigen::Quaterniond::Identity(),
                                          Eigen::Vector3d(0.0, 0.0, kStep_m * i)},
                      .reference = i - 1,
                      .source = PoseSource::kOdometry,
                      .keyframe = true,
                      .offset = {longer_per_px * kStep_m, offset_px * information, information}});
  }
  return motion;
}

// By hand, from the turn about y and the principal points alone.
double OffsetSigmaPx(const StereoRig& rig, const AdjustmentOptions& options) {
  const double turn_px = options.rig_prior_deg * std::numbers::pi / 180.0 * rig.left.camera.fx;
  return std::hypot(turn_px, std::sqrt(2.0) * options.principal_point_prior_px);
}

TEST(UncheckedScaleOf, IsThatOfAnOffsetOfAllDisparitiesAndOfTheFocalLength) {
  const StereoRig rig = LocCamRig();
  const AdjustmentOptions options;
  const double expected =
      std::hypot(0.03 * OffsetSigmaPx(rig, options), 0.01 * options.focal_prior_pct);
  EXPECT_NEAR(UncheckedScaleOf(rig, Drive(0.03, 0.0, 0.0), options).sigma, expected,
              0.15 * expected);
  EXPECT_NEAR(UncheckedScaleOf(rig, {}, options).sigma, 0.01 * options.focal_prior_pct, 1e-9);
}

TEST(UncheckedScaleOf, CountsStepsBetweenKeyframesOnceAndThoseThatStandNever) {
  const StereoRig rig = LocCamRig();
  const AdjustmentOptions options{.focal_prior_pct = 1e-6};
  const double expected = UncheckedScaleOf(rig, Drive(0.03, 0.0, 0.0), options).sigma;
  Odometry motion = Drive(0.03, 0.0, 0.0);
  OdometryFrame between = motion.back(), still = motion.back();
  between.keyframe = false;
  between.offset.lengthening_m_per_px = 1.0;
  motion.insert(motion.end() - 1, between);
  still.reference = static_cast<int>(motion.size()) - 1;
  still.stands_still = true;
  still.offset.lengthening_m_per_px = 1.0;
  motion.push_back(still);
  EXPECT_NEAR(UncheckedScaleOf(rig, motion, options).sigma, expected, 1e-9);
}

TEST(UncheckedScaleOf, CountsTheOffsetThatTheStepsAskFor) {
  const StereoRig rig = LocCamRig();
  const AdjustmentOptions options{.focal_prior_pct = 1e-6};
  const double by_prior = UncheckedScaleOf(rig, Drive(0.03, 0.0, 100.0), options).sigma;
  const UncheckedScale asked = UncheckedScaleOf(rig, Drive(0.03, 3.0, 100.0), options);
  EXPECT_NEAR(asked.asked_offset_px, 3.0, 0.05);
  EXPECT_NEAR(asked.sigma, std::hypot(by_prior, 0.03 * asked.asked_offset_px), 1e-9);
  // What says next to nothing does not outweigh the prior.
  EXPECT_LT(UncheckedScaleOf(rig, Drive(0.03, 3.0, 1e-3), options).asked_offset_px, 0.1);
}

TEST(UncheckedScaleOf, IsSmallWhereTheRigFileKnowsItsCalibration) {
  StereoRig rig = LocCamRig();
  const AdjustmentOptions options;
  const Odometry motion = Drive(0.03, 0.0, 0.0);
  const double by_prior = UncheckedScaleOf(rig, motion, options).sigma;
  rig.calibration_covariance = 0.01 * PriorOf(rig, options).information.inverse();
  EXPECT_NEAR(UncheckedScaleOf(rig, motion, options).sigma, 0.1 * by_prior, 0.01 * by_prior);
}

TEST(UncheckedFocalSigma, IsWhatThePriorOrTheRigFileSays) {
  StereoRig rig = LocCamRig();
  EXPECT_NEAR(UncheckedFocalSigma(rig, {.focal_prior_pct = 0.7}), 0.007, 1e-9);
  rig.calibration_covariance = 1e-6 * CalibrationMatrix::Identity();
  EXPECT_NEAR(UncheckedFocalSigma(rig, {}), 0.001, 1e-12);
}

}  // namespace
}  // namespace rigmap
