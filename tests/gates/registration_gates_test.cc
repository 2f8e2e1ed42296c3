#include "gates/registration_gates.h"

#include <gtest/gtest.h>

namespace rigmap {
namespace {

constexpr double kAhead_m = 0.2;

// Straight ahead; every frame but the first registered against the one before.
Registration Straight(int count) {
  Registration registration{.grid_m = 0.05};
  for (int i = 0; i < count; ++i) {
    OdometryFrame frame{.stamp_ns = i,
                        .world_from_left = {Eigen::Quaterniond::Identity(), {0, 0, kAhead_m * i}},
                        .reference = std::max(0, i - 1),
                        .step_covariance = 1e-6 * Matrix6d::Identity(),
                        .source = PoseSource::kOdometry};
    registration.motion.push_back(frame);
    RegisteredFrame found{.converged = true, .held = true, .overlap = 0.9};
    if (i >= 2) {
      found.closure_m = 0.004;
      found.closure_sigmas = 1.0;
    }
    registration.frames.push_back(found);
  }
  return registration;
}

const Gate& Named(const Gates& gates, const std::string& name) {
  for (const Gate& gate : gates) {
    if (gate.name == name) return gate;
  }
  throw std::logic_error(name);
}

TEST(JudgeRegistration, PassesWhatIsHeldAndAgreesWithItself) {
  const Gates gates = JudgeRegistration(Straight(12), {});
  EXPECT_TRUE(AllPassed(gates));
  // 4 mm of 40 cm.
  EXPECT_NEAR(*Named(gates, "closure_pct").value, 1.0, 1e-9);
  EXPECT_EQ(*Named(gates, "unheld").value, 0.0);
}

TEST(JudgeRegistration, FailsWhatSlidesOrContradictsItself) {
  Registration sliding = Straight(10);
  for (int i = 3; i < 6; ++i) sliding.frames[i].held = false;
  EXPECT_FALSE(Named(JudgeRegistration(sliding, {}), "unheld").passed);
  Registration torn = Straight(10);
  for (RegisteredFrame& frame : torn.frames) frame.closure_m = 0.04;
  // No more than their sigmas say.
  EXPECT_TRUE(Named(JudgeRegistration(torn, {}), "closure_pct").passed);
  for (RegisteredFrame& frame : torn.frames) frame.closure_sigmas = 8.0;
  EXPECT_FALSE(Named(JudgeRegistration(torn, {}), "closure_pct").passed);
}

TEST(JudgeRegistration, ARigThatStandsIsMeasuredByABox) {
  Registration still = Straight(6);
  for (OdometryFrame& frame : still.motion) frame.world_from_left = {};
  for (RegisteredFrame& frame : still.frames) frame.closure_m = 0.001;
  EXPECT_NEAR(*Named(JudgeRegistration(still, {}), "closure_pct").value, 2.0, 1e-9);
}

TEST(JudgeRegistration, NothingRegisteredTwiceSaysNothing) {
  const Gates gates = JudgeRegistration(Straight(2), {});
  EXPECT_FALSE(Named(gates, "closure_pct").value);
  EXPECT_TRUE(Named(gates, "closure_pct").passed);
}

TEST(WithNoiseOf, AddsWhatBothEndsOfAStepAreKnownBy) {
  const Registration registration = Straight(5);
  Odometry odometry = registration.motion;
  // One step hangs on the same frame, one on another.
  odometry[4].reference = 2;
  const Odometry compared = WithNoiseOf(registration, odometry);
  EXPECT_NEAR(compared[3].step_covariance(0, 0), 2e-6, 1e-12);
  EXPECT_NEAR(compared[4].step_covariance(0, 0), 3e-6, 1e-12);
}

TEST(AsAdjustment, HasThePosesThatWereRegistered) {
  Registration registration = Straight(5);
  registration.motion[0].source = registration.motion[3].source = PoseSource::kPredicted;
  const Adjustment poses = AsAdjustment(registration);
  EXPECT_FALSE(poses.world_from_left[0]);
  EXPECT_FALSE(poses.world_from_left[3]);
  EXPECT_TRUE(poses.world_from_left[4]);
  EXPECT_EQ(poses.datum_frames[4], 1);
}

}  // namespace
}  // namespace rigmap
