#include "gates/accuracy.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/support/seeded_random.h"
#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

TEST(Radius95, HoldsNineteenOfTwentyErrors) {
  SeededRandom random;
  for (const Eigen::Vector3d& sigmas :
       {Eigen::Vector3d(1.0, 1.0, 1.0), Eigen::Vector3d(3.0, 1.0, 0.1),
        Eigen::Vector3d(1.0, 0.0, 0.0), Eigen::Vector3d(2.0, 2.0, 0.2)}) {
    const Eigen::Matrix3d turn = random.Motion(1.0).rotation.toRotationMatrix();
    const Eigen::Matrix3d covariance = turn * sigmas.cwiseAbs2().asDiagonal() * turn.transpose();
    const double radius = Radius95(covariance);
    int inside = 0;
    constexpr int kDraws = 20000;
    for (int i = 0; i < kDraws; ++i) {
      const Eigen::Vector3d error(random.Normal(sigmas.x()), random.Normal(sigmas.y()),
                                  random.Normal(sigmas.z()));
      if (error.norm() <= radius) ++inside;
    }
    EXPECT_NEAR(static_cast<double>(inside) / kDraws, 0.95, 0.01) << sigmas.transpose();
  }
  EXPECT_EQ(Radius95(Eigen::Matrix3d::Zero()), 0.0);
}

// Ten steps of half a metre along x.
Trajectory Drive() {
  Trajectory trajectory;
  for (int i = 0; i <= 10; ++i) {
    TimedPose& pose = trajectory.emplace_back();
    pose.stamp_ns = i;
    pose.world_from_left.translation.x() = 0.5 * i;
    pose.source = PoseSource::kOdometry;
  }
  return trajectory;
}

TEST(AccuracyOf, TakesTheScaleOfTheAdjustmentElseOfTheFarthestFrame) {
  Trajectory trajectory = Drive();
  Adjustment adjustment;
  // Along the way and sideways; correlations count: sideways sigmas alone say nothing of the scale.
  trajectory.back().position_covariance << 0.0004, 0.0003, 0.0, 0.0003, 0.01, 0.0, 0.0, 0.0, 0.0;
  const Accuracy by_distance = AccuracyOf(trajectory, adjustment, LocCamRig());
  EXPECT_NEAR(by_distance.scale_95_pct.value(), 100.0 * 1.96 * 0.02 / 5.0, 1e-9);
  EXPECT_NEAR(by_distance.path_m, 5.0, 1e-12);
  adjustment.scale_sigma = 0.001;
  EXPECT_NEAR(AccuracyOf(trajectory, adjustment, LocCamRig()).scale_95_pct.value(), 0.196, 1e-9);
}

// Once round, the step at the far end known to 2 cm only: the way to the farthest pose, which lies
// before it, tells nothing of that; a similarity alignment feels it.
TEST(AccuracyOf, AWeakStepInTheMidstOfALoopCountsForTheScale) {
  Trajectory trajectory;
  for (int i = 0; i <= 40; ++i) {
    TimedPose pose{.stamp_ns = i};
    pose.source = PoseSource::kOdometry;
    const double turn = 2.0 * std::numbers::pi * i / 40;
    pose.world_from_left.translation = {2.0 * std::sin(turn), 2.0 - 2.0 * std::cos(turn), 0.0};
    if (i > 20) pose.position_covariance = 4e-4 * Eigen::Matrix3d::Identity();
    trajectory.push_back(pose);
  }
  // The half circle behind the step moves by d: the factor changes by d times the sum of its ways,
  // 20 times 2 / pi of the radius, over that of squares, 41 of it.
  const double moved = 20.0 * 2.0 / std::numbers::pi * 2.0 / (41.0 * 4.0);
  EXPECT_NEAR(AccuracyOf(trajectory, {}, LocCamRig()).scale_95_pct.value(), 196.0 * 0.02 * moved,
              0.03);
}

TEST(AccuracyOf, OfPosesThatNobodyVouchesForIsTheAdjustmentsScaleOrNothing) {
  Trajectory trajectory = Drive();
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  for (TimedPose& pose : trajectory) pose.position_covariance.setConstant(unknown);
  Adjustment adjustment;
  const Accuracy nothing =
      AccuracyOf(trajectory, adjustment, LocCamRig(), {.positions_known = false});
  EXPECT_FALSE(nothing.scale_95_pct || nothing.position_95_m || nothing.position_95_pct);
  adjustment.scale_sigma = 0.001;
  const Accuracy scale =
      AccuracyOf(trajectory, adjustment, LocCamRig(), {.positions_known = false});
  EXPECT_NEAR(scale.scale_95_pct.value(), 0.196, 1e-9);
  EXPECT_FALSE(scale.position_95_m);
  // Where somebody does, what is not a number is not known.
  EXPECT_EQ(AccuracyOf(trajectory, adjustment, LocCamRig()).position_95_m,
            std::numeric_limits<double>::infinity());
}

TEST(AccuracyOf, CountsWhatTheCalibrationLeavesUnknownOfAllLengths) {
  const Trajectory trajectory = Drive();  // 5 m, without any noise
  const Accuracy found = AccuracyOf(trajectory, {}, LocCamRig(), {.calibration_scale_sigma = 0.02});
  EXPECT_NEAR(found.scale_95_pct.value(), 1.96 * 2.0, 1e-3);
  EXPECT_EQ(found.noise_95_pct, 0.0);  // so that a refusal names the calibration
  // Along the way alone: the 95 % of one direction.
  EXPECT_NEAR(found.position_95_m.value(), 1.96 * 0.02 * 5.0, 0.01);
}

TEST(AccuracyOf, CountsDepthsThatContradictEachOther) {
  Adjustment adjustment;
  adjustment.scale_sigma = 0.003;
  adjustment.scale_sigma_of_noise = 0.001;
  const Accuracy found =
      AccuracyOf(Drive(), adjustment, LocCamRig(), {.depth_contradiction = 0.004});
  EXPECT_NEAR(found.scale_95_pct.value(), 1.96 * 0.5, 1e-9);
  EXPECT_NEAR(found.noise_95_pct.value(), 0.196, 1e-9);
  EXPECT_NEAR(found.position_95_m.value(), 1.96 * 0.004 * 5.0, 0.002);
}

TEST(AccuracyOf, IsInfiniteWhereTheCalibrationLeavesNoLengthKnown) {
  const Accuracy found =
      AccuracyOf(Drive(), {}, LocCamRig(),
                 {.calibration_scale_sigma = std::numeric_limits<double>::infinity()});
  EXPECT_GT(found.path_m, 0.0);
  EXPECT_TRUE(std::isinf(found.scale_95_pct.value()));
  EXPECT_TRUE(std::isinf(found.position_95_pct.value()));
}

TEST(AccuracyOf, OfAWayThatTurnsTheDirectionCounts) {
  // 2 mm known along a slanting way, whose coordinates are known to 1 cm each: they err together.
  Trajectory trajectory = Drive();
  for (TimedPose& pose : trajectory) {
    const double x = pose.world_from_left.translation.x();
    pose.world_from_left.translation = Eigen::Vector3d(x, x, 0.0) / std::sqrt(2.0);
  }
  const Eigen::Vector3d along = Eigen::Vector3d(1.0, 1.0, 0.0).normalized(),
                        across = Eigen::Vector3d(1.0, -1.0, 0.0).normalized();
  trajectory.back().position_covariance =
      4e-6 * along * along.transpose() + 2e-4 * across * across.transpose();
  const auto scale = AccuracyOf(trajectory, {}, LocCamRig()).scale_95_pct;
  EXPECT_NEAR(scale.value(), 100.0 * 1.96 * 0.002 / 5.0, 1e-9);
}

TEST(AccuracyOf, CountsTheStatedSigmaOfTheBaseline) {
  const Trajectory trajectory = Drive();
  Adjustment adjustment;
  adjustment.scale_sigma = 0.0;
  StereoRig rig = LocCamRig();
  EXPECT_EQ(AccuracyOf(trajectory, adjustment, rig).scale_95_pct, 0.0);
  rig.baseline_sigma_m = 0.01 * rig.Baseline();
  const Accuracy accuracy = AccuracyOf(trajectory, adjustment, rig);
  EXPECT_NEAR(accuracy.scale_95_pct.value(), 1.96, 1e-9);
  EXPECT_NEAR(accuracy.baseline_95_pct.value(), 1.96, 1e-9);
  EXPECT_FALSE(accuracy.noise_95_pct);
  adjustment.scale_sigma_of_noise = 0.001;
  EXPECT_NEAR(AccuracyOf(trajectory, adjustment, rig).noise_95_pct.value(), 0.196, 1e-9);
  EXPECT_NEAR(accuracy.position_95_m.value(), 1.96 * 0.05, 0.002);  // 5 m from the start
}

TEST(AccuracyOf, WhatIsNotANumberIsNotKnown) {
  Trajectory trajectory = Drive();
  trajectory.back().position_covariance(0, 0) = std::nan("");
  const Accuracy accuracy = AccuracyOf(trajectory, {}, LocCamRig());
  EXPECT_TRUE(std::isinf(accuracy.scale_95_pct.value()));
  EXPECT_TRUE(std::isinf(accuracy.position_95_m.value()));
}

TEST(AccuracyOf, OfARigThatStandsHasPositionsButNoScale) {
  Trajectory trajectory = Drive();
  for (TimedPose& pose : trajectory) pose.world_from_left.translation *= 0.01;
  trajectory.back().position_covariance = 1e-4 * Eigen::Matrix3d::Identity();
  const Accuracy accuracy = AccuracyOf(trajectory, {}, LocCamRig());
  EXPECT_FALSE(accuracy.scale_95_pct);
  EXPECT_NEAR(accuracy.position_95_m.value(), 0.028, 0.001);
  EXPECT_NEAR(accuracy.position_95_pct.value(), 2.8, 0.1);  // of a metre
  EXPECT_FALSE(AccuracyOf({}, {}, LocCamRig()).scale_95_pct);
  EXPECT_FALSE(AccuracyOf({trajectory.front()}, {}, LocCamRig()).position_95_m);
}

// Else one guess far off would make all positions look good.
TEST(AccuracyOf, AGuessMakesNoWay) {
  Trajectory trajectory = Drive();
  TimedPose guess = trajectory.back();
  guess.source = PoseSource::kPredicted;
  guess.world_from_left.translation.x() = 150.0;
  trajectory.push_back(guess);
  EXPECT_NEAR(AccuracyOf(trajectory, {}, LocCamRig()).path_m, 5.0, 1e-12);
  trajectory.front().source = PoseSource::kPredicted;
  EXPECT_NEAR(AccuracyOf(trajectory, {}, LocCamRig()).path_m, 4.5, 1e-12);
}

// Covariances are relative to the first pose that was measured, and so are ways.
TEST(AccuracyOf, CountsWaysFromTheFirstMeasuredPose) {
  Trajectory trajectory = Drive();
  trajectory.back().position_covariance(0, 0) = 0.0004;
  const auto plain = AccuracyOf(trajectory, {}, LocCamRig(), {.calibration_scale_sigma = 0.01});
  TimedPose guess{.stamp_ns = -1};
  guess.world_from_left.translation.x() = -20.0;
  trajectory.insert(trajectory.begin(), guess);
  const auto late = AccuracyOf(trajectory, {}, LocCamRig(), {.calibration_scale_sigma = 0.01});
  EXPECT_DOUBLE_EQ(late.scale_95_pct.value(), plain.scale_95_pct.value());
  EXPECT_DOUBLE_EQ(late.position_95_m.value(), plain.position_95_m.value());
}

}  // namespace
}  // namespace rigmap
