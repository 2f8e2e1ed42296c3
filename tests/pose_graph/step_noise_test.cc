#include "pose_graph/internal/step_noise.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

constexpr int kSteps = 200;
constexpr double kStep_m = 0.25, kFloor_m = StepNoise().metres;

Trajectory StraightWay() {
  Trajectory poses;
  for (int i = 0; i <= kSteps; ++i) {
    poses.push_back({.stamp_ns = i * 1'000'000'000LL,
                     .world_from_left = {Eigen::Quaterniond::Identity(), {i * kStep_m, 0.0, 0.0}},
                     .source = PoseSource::kAdjusted});
  }
  return poses;
}

void State(TimedPose& pose, double metres, double radians) {
  pose.sigmas << Eigen::Vector3d::Constant(metres), Eigen::Vector3d::Constant(radians);
  pose.position_covariance = metres * metres * Eigen::Matrix3d::Identity();
}

// As far off as headings that walk by a milliradian a step take the end, in many ways driven.
TEST(NoisePerStep, WhatHeadingsExplainIsNoNoiseOfPositions) {
  constexpr int kWays = 400;
  constexpr double kTurn = 1e-3;
  SeededRandom random;
  double squares_m2 = 0.0;
  for (int way = 0; way < kWays; ++way) {
    Eigen::Vector3d turned = Eigen::Vector3d::Zero(), off = Eigen::Vector3d::Zero();
    for (int i = 0; i < kSteps; ++i) {
      off += turned.cross(kStep_m * Eigen::Vector3d::UnitX());
      turned += random.Noise(kTurn);
    }
    squares_m2 += off.squaredNorm() / kWays;
  }
  Trajectory poses = StraightWay();
  State(poses.back(), std::sqrt(squares_m2 / 3.0), kTurn * std::sqrt(kSteps));
  const auto noise = NoisePerStep(poses, {}, 0.0);
  EXPECT_NEAR(noise.back().radians, kTurn, 1e-9);
  // A fifth of the square may be chance, a tenth is none of the way's.
  const double all_m = std::sqrt(squares_m2 / (3.0 * kSteps));
  EXPECT_LT(noise.back().metres, 0.45 * all_m);
  // What is beyond that is.
  State(poses.back(), std::sqrt(4.0 * squares_m2 / 3.0), kTurn * std::sqrt(kSteps));
  EXPECT_NEAR(NoisePerStep(poses, {}, 0.0).back().metres, std::sqrt(3.0) * all_m, 0.2 * all_m);
}

// Out and back the length of the way is no lever: what turns and scale move there they move back.
TEST(NoisePerStep, OfAWayThatComesBackIsNotExplainedByItsLength) {
  Trajectory poses = StraightWay();
  for (std::size_t i = kSteps / 2 + 1; i < poses.size(); ++i) {
    poses[i].world_from_left.translation.x() = static_cast<double>(kSteps - i) * kStep_m;
  }
  constexpr double kTurn = 1e-4, kStepNoise_m = 2e-3;
  double by_turns_m2 = 0.0;
  for (const TimedPose& pose : poses) {
    by_turns_m2 += 2.0 * std::pow(kTurn * pose.world_from_left.translation.x(), 2);
  }
  State(poses.back(), std::sqrt(by_turns_m2 / 3.0 + kSteps * kStepNoise_m * kStepNoise_m),
        kTurn * std::sqrt(kSteps));
  EXPECT_NEAR(NoisePerStep(poses, {}, 0.005).back().metres, kStepNoise_m, 0.02 * kStepNoise_m);
}

TEST(NoisePerStep, IsOfMeasuredPosesWhateverIsGuessedBeforeThem) {
  Trajectory poses = StraightWay();
  State(poses.back(), 0.1, 1e-3);
  const auto plain = NoisePerStep(poses, {}, 0.0);
  EXPECT_GT(plain.back().metres, 10.0 * kFloor_m);
  constexpr int kGuessed = 4;
  Trajectory late(poses.begin(), poses.begin() + kGuessed);
  for (TimedPose& pose : late) {
    pose.source = PoseSource::kPredicted;
    State(pose, 0.6, 0.1);
  }
  late.insert(late.end(), poses.begin(), poses.end());
  EXPECT_EQ(FirstMeasured(late), static_cast<std::size_t>(kGuessed));
  const auto noise = NoisePerStep(late, {}, 0.0);
  EXPECT_DOUBLE_EQ(noise.back().metres, plain.back().metres);
  EXPECT_DOUBLE_EQ(noise.back().radians, plain.back().radians);
  EXPECT_DOUBLE_EQ(noise[kGuessed + 1].metres, plain[1].metres);
  EXPECT_NEAR(noise[1].metres, 0.6, 1e-9);
  EXPECT_NEAR(noise[kGuessed].radians, 0.1, 1e-9);
}

TEST(NoisePerStep, GuessesAtTheEndLoosenNothingElse) {
  Trajectory poses = StraightWay();
  State(poses.back(), 0.1, 1e-3);
  const auto plain = NoisePerStep(poses, {}, 0.0);
  poses.push_back(poses.back());
  poses.back().source = PoseSource::kPredicted;
  State(poses.back(), 2.0, 0.3);
  const auto noise = NoisePerStep(poses, {}, 0.0);
  EXPECT_DOUBLE_EQ(noise[1].metres, plain[1].metres);
  EXPECT_NEAR(noise.back().metres, std::sqrt(4.0 - 0.01), 1e-9);
}

// Two hundred good steps are none the looser for one that wheels bridged.
TEST(NoisePerStep, OneLooseStepIsLooseByItself) {
  constexpr int kLoose = 120;
  Trajectory poses = StraightWay();
  State(poses.back(), 0.15, 1e-3);
  const auto covariance = [](double metres, double radians) {
    Vector6d sigmas;
    sigmas << Eigen::Vector3d::Constant(metres), Eigen::Vector3d::Constant(radians);
    return Matrix6d(sigmas.cwiseAbs2().asDiagonal());
  };
  StepCovariances known(poses.size(), covariance(1e-3, 1e-5));
  known[kLoose] = covariance(0.15, 1e-5);
  known[7].reset();
  const auto noise = NoisePerStep(poses, known, 0.0);
  EXPECT_NEAR(noise[kLoose].metres, 0.15, 0.015);
  EXPECT_LT(noise[kLoose + 1].metres, 2e-3);
  EXPECT_LT(noise[7].metres, 2e-3);
  // So it is behind a gap that was guessed, whose sigma all behind it has.
  for (std::size_t i = kLoose; i < poses.size(); ++i) State(poses[i], 1.0, 1e-3);
  poses[kLoose].source = PoseSource::kPredicted;
  const auto guessed = NoisePerStep(poses, StepCovariances(), 0.0);
  EXPECT_NEAR(guessed[kLoose].metres, 1.0, 1e-6);
  EXPECT_LT(guessed[kLoose - 1].metres, 5e-3);
}

}  // namespace
}  // namespace rigmap
