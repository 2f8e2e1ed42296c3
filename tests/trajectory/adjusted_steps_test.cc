#include "trajectory/adjusted_steps.h"

#include "geometry/carried_covariance.h"
#include "tests/trajectory/odometric_part.h"

namespace rigmap {
namespace {

Part Adjusted(int frames) {
  Part part(frames);
  for (int i = 1; i < frames; ++i) {
    part.Adjust(i, part.odometry[i].world_from_left, Diagonal(0.1, 0.01));
  }
  part.TellLinks(Diagonal(0.002, 1e-4));
  return part;
}

TEST(AdjustedSteps, AreAboutTheAxesOfTheLaterFrame) {
  Part part = Adjusted(4);
  Matrix6d along = Matrix6d::Zero();
  along(2, 2) = 1e-4;  // along the third frame's own z
  const Rigid3& third = *part.adjustment.world_from_left[3];
  part.adjustment.link_covariances[3] = Turned(along, third);
  const auto steps = AdjustedSteps(part.odometry, part.adjustment);
  ASSERT_EQ(steps.size(), 4u);
  ASSERT_TRUE(steps[3]);
  EXPECT_LT((*steps[3] - along).norm(), 1e-12);
}

TEST(AdjustedSteps, AreNoneOfWhatTheAdjustmentDoesNotTell) {
  Part part = Adjusted(4);
  part.adjustment.link_covariances[2].reset();
  const auto steps = AdjustedSteps(part.odometry, part.adjustment);
  EXPECT_FALSE(steps[0]);
  EXPECT_TRUE(steps[1]);
  EXPECT_FALSE(steps[2]);
  part.adjustment.link_covariances.clear();
  for (const auto& step : AdjustedSteps(part.odometry, part.adjustment)) EXPECT_FALSE(step);
}

// A calibration that turns the whole drive about its start, and lengthens it.
TEST(AdjustedSteps, CountOfTheCalibrationWhatItDoesToTheStep) {
  Part part = Adjusted(4);
  constexpr double kTurn_rad = 0.01, kLengthening = 0.02;
  part.adjustment.by_calibration.assign(4, PoseCalibration::Zero());
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector3d& arm = part.adjustment.world_from_left[i]->translation;
    PoseCalibration& by = part.adjustment.by_calibration[i];
    by.col(0) << Eigen::Vector3d::UnitY().cross(arm), Eigen::Vector3d::UnitY();
    by.col(1) << arm, Eigen::Vector3d::Zero();
  }
  part.adjustment.calibration_covariance(0, 0) = kTurn_rad * kTurn_rad;
  const Matrix6d noise = Diagonal(0.002, 1e-4);
  const auto turned = AdjustedSteps(part.odometry, part.adjustment);
  EXPECT_LT((*turned[3] - noise).norm(), 1e-12);  // every step as it was

  part.adjustment.calibration_covariance(1, 1) = kLengthening * kLengthening;
  const auto lengthened = AdjustedSteps(part.odometry, part.adjustment);
  const double step_m = part.Step(2, 3).translation.norm();
  EXPECT_NEAR((*lengthened[3] - noise).trace(), std::pow(kLengthening * step_m, 2), 1e-12);
}

}  // namespace
}  // namespace rigmap
