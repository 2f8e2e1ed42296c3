#include "gates/internal/motion_gates.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <optional>

namespace rigmap {
namespace {

// 64 steps straight ahead, along the left camera's z, which map and odometry tell alike.
class DriftTest : public testing::Test {
 protected:
  static constexpr double kStep_m = 0.5, kStepSigma_m = 0.001, kStepSigma_rad = 0.0005,
                          kAccuracy_pct = 1.0;

  DriftTest() {
    for (int i = 0; i <= 64; ++i) {
      const Rigid3 pose{Eigen::Quaterniond::Identity(), {0.0, 0.0, kStep_m * i}};
      OdometryFrame frame{.stamp_ns = i, .world_from_left = pose, .reference = std::max(0, i - 1)};
      frame.source = PoseSource::kOdometry;
      frame.step_covariance.diagonal() << Eigen::Vector3d::Constant(kStepSigma_m * kStepSigma_m),
          Eigen::Vector3d::Constant(kStepSigma_rad * kStepSigma_rad);
      odometry_.push_back(frame);
      adjustment_.world_from_left.push_back(pose);
    }
  }

  // From this frame on the map is moved by `by`, in the frame's own axes.
  void Tear(int frame, const Rigid3& by) {
    const Rigid3 pose = *adjustment_.world_from_left[frame];
    const Rigid3 moved = pose * by * pose.Inverse();
    for (int i = frame; i < std::ssize(odometry_); ++i) {
      adjustment_.world_from_left[i] = moved * *adjustment_.world_from_left[i];
    }
  }
  void TearAll(const Rigid3& by) {
    for (int i = 1; i < std::ssize(odometry_); ++i) Tear(i, by);
  }
  Rigid3 Ahead(double metres) const { return {Eigen::Quaterniond::Identity(), {0.0, 0.0, metres}}; }

  GateInputs Inputs() const { return {rig_, odometry_, adjustment_, trajectory_}; }
  Gate Drift(double accuracy_pct = kAccuracy_pct) const {
    return JudgeDrift(Inputs(), options_, accuracy_pct);
  }
  bool DoStepsPass() const {
    Gates gates;
    JudgeSteps(Inputs(), options_, gates);
    return AllPassed(gates);
  }

  StereoRig rig_;
  Odometry odometry_;
  Adjustment adjustment_;
  Trajectory trajectory_;
  AdjustmentGateOptions options_;
};

TEST_F(DriftTest, EqualMotionsDoNotDrift) {
  EXPECT_NEAR(Drift().value.value(), 0.0, 1e-9);
  EXPECT_TRUE(Drift().passed);
}

TEST_F(DriftTest, AMapThatIsSlightlyTooLongInEachStepFails) {
  TearAll(Ahead(0.012 * kStep_m));
  EXPECT_TRUE(DoStepsPass()) << "six sigmas along one of six axes";
  EXPECT_FALSE(Drift().passed);
  EXPECT_TRUE(Drift(1.3).passed) << "no more than what was asked for";
}

TEST_F(DriftTest, WhatNoiseExplainsPasses) {
  TearAll(Ahead(0.012 * kStep_m));
  for (OdometryFrame& frame : odometry_) frame.step_covariance *= 9.0;
  EXPECT_TRUE(Drift().passed);
}

TEST_F(DriftTest, AMapThatTurnsSlightlyInEachStepFails) {
  TearAll({ExpRotation({0.0, 8.0 * kStepSigma_rad, 0.0}), Eigen::Vector3d::Zero()});
  EXPECT_TRUE(DoStepsPass()) << "no step is shorter";
  EXPECT_FALSE(Drift().passed);
}

TEST_F(DriftTest, ATenthOfTheStepsTornAlikeFails) {
  for (int i = 5; i <= 64; i += 10) Tear(i, Ahead(0.12 * kStep_m));
  EXPECT_TRUE(DoStepsPass()) << "each by itself, and nine out of ten are right";
  EXPECT_FALSE(Drift().passed);
}

TEST_F(DriftTest, WhatAveragesOutPasses) {
  for (int i = 1; i <= 64; ++i) Tear(i, Ahead((i % 2 == 0 ? 0.04 : -0.04) * kStep_m));
  EXPECT_TRUE(DoStepsPass());
  EXPECT_TRUE(Drift().passed);
}

TEST_F(DriftTest, OneWrongMotionOfTheOdometryPasses) {
  for (const int frame : {2, 33, 60}) {
    const auto kept = adjustment_.world_from_left;
    Tear(frame, Ahead(0.14 * kStep_m));
    EXPECT_TRUE(Drift().passed) << frame;
    adjustment_.world_from_left = kept;
  }
}

TEST_F(DriftTest, FramesThatAreNotAdjustedAreLeftOut) {
  TearAll(Ahead(0.012 * kStep_m));
  for (int i = 0; i <= 64; i += 3) adjustment_.world_from_left[i].reset();
  EXPECT_FALSE(Drift().passed);
  for (auto& pose : adjustment_.world_from_left) pose.reset();
  EXPECT_FALSE(Drift().value);
  EXPECT_TRUE(Drift().passed);
}

TEST_F(DriftTest, AGapThatNobodyMeasuredEndsAWay) {
  Tear(32, Ahead(10.0));
  odometry_[32].source = PoseSource::kPredicted;
  EXPECT_NEAR(Drift().value.value(), 0.0, 1e-9);
}

TEST_F(DriftTest, ReferencesInACircleHaveAnEnd) {
  odometry_[1].reference = 2;
  EXPECT_TRUE(Drift().passed);
}

TEST_F(DriftTest, WhatIsNoNumberFails) {
  adjustment_.world_from_left[7]->translation.x() = std::numeric_limits<double>::quiet_NaN();
  for (int i = 8; i <= 64; ++i) adjustment_.world_from_left[i] = adjustment_.world_from_left[7];
  EXPECT_FALSE(Drift().passed);
}

}  // namespace
}  // namespace rigmap
