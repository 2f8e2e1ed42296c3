#include "evaluation/trajectory_metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <vector>

#include "core/error.h"
#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

using Poses = std::vector<TumPose>;

constexpr StampNs kFirstStampNs = 1448551416619000000;
constexpr StampNs kIntervalNs = 400'000'000;

// A winding drive of about 0.2 m per pose.
Poses Drive(int count) {
  Poses poses;
  Rigid3 world_from_body;
  for (int i = 0; i < count; ++i) {
    poses.push_back({kFirstStampNs + i * kIntervalNs, world_from_body});
    world_from_body = world_from_body * Rigid3{ExpRotation({0.01 * std::sin(0.1 * i), 0.02, 0.03}),
                                               Eigen::Vector3d(0.2, 0.01, 0.0)};
  }
  return poses;
}

Poses MovedPoses(const Sim3& other_from_world, Poses poses) {
  for (TumPose& pose : poses) {
    pose.world_from_body = TransformPose(other_from_world, pose.world_from_body);
  }
  return poses;
}

TEST(CompareTrajectories, FindsNoErrorInTheTruth) {
  const Poses truth = Drive(50);
  const TrajectoryMetrics metrics = CompareTrajectories(truth, truth);
  EXPECT_EQ(metrics.frames, 50U);
  EXPECT_EQ(metrics.true_frames, 50U);
  EXPECT_EQ(metrics.coverage, 1.0);
  EXPECT_NEAR(metrics.true_path_m, 49.0 * std::hypot(0.2, 0.01), 1e-9);
  EXPECT_EQ(metrics.estimated_path_m, metrics.true_path_m);
  ASSERT_TRUE(metrics.aligned && metrics.relative);
  EXPECT_LT(metrics.aligned->ate_se3_m, 1e-9);
  EXPECT_LT(metrics.aligned->ate_sim3_m.value(), 1e-9);
  EXPECT_NEAR(metrics.aligned->scale.value(), 1.0, 1e-9);
  EXPECT_LT(metrics.relative->translation_pct, 1e-9);
  EXPECT_LT(metrics.relative->rotation_deg_per_m, 1e-9);
  EXPECT_NEAR(metrics.relative->segment_m, metrics.true_path_m / 5.0, 1e-9);
}

TEST(CompareTrajectories, DoesNotDependOnTheWorldOfTheEstimate) {
  SeededRandom random;
  const Poses truth = Drive(50);
  Poses estimate = truth;
  for (TumPose& pose : estimate) {
    pose.world_from_body = pose.world_from_body * random.Motion(0.02, 0.01);
  }
  const Rigid3 motion = random.Motion(100.0);
  const Poses moved = MovedPoses({1.0, motion.rotation, motion.translation}, estimate);
  const TrajectoryMetrics before = CompareTrajectories(estimate, truth);
  const TrajectoryMetrics after = CompareTrajectories(moved, truth);
  EXPECT_GT(before.aligned->ate_se3_m, 1e-3);
  EXPECT_NEAR(after.aligned->ate_se3_m, before.aligned->ate_se3_m, 1e-9);
  EXPECT_NEAR(*after.aligned->ate_sim3_m, *before.aligned->ate_sim3_m, 1e-9);
  EXPECT_NEAR(after.relative->translation_pct, before.relative->translation_pct, 1e-8);
  EXPECT_NEAR(after.relative->rotation_deg_per_m, before.relative->rotation_deg_per_m, 1e-8);
  EXPECT_NEAR(after.extent_m, before.extent_m, 1e-9);
}

TEST(CompareTrajectories, ShowsAWrongScale) {
  const Poses truth = Drive(50);
  const Sim3 shrunk_from_true{1.0 / 1.01, ExpRotation({0.3, 0.2, -0.1}), {1.0, 2.0, 3.0}};
  const TrajectoryMetrics metrics = CompareTrajectories(MovedPoses(shrunk_from_true, truth), truth);
  EXPECT_NEAR(metrics.aligned->scale.value(), 1.01, 1e-9);
  EXPECT_LT(metrics.aligned->ate_sim3_m.value(), 1e-9);
  EXPECT_GT(metrics.aligned->ate_se3_m, 0.001);
  EXPECT_NEAR(metrics.estimated_path_m * 1.01, metrics.true_path_m, 1e-9);
  EXPECT_LE(metrics.relative->translation_pct, 100.0 * (1.0 - 1.0 / 1.01));
  EXPECT_GT(metrics.relative->translation_pct, 0.5);
  EXPECT_EQ(ToJson(metrics)["scale_error_pct"].get<double>(), 1.0);
}

TEST(CompareTrajectories, ShowsADriftOfTheHeadingPerMetre) {
  Poses truth(51), estimate(51);
  for (int i = 0; i < 51; ++i) {
    truth[i].stamp_ns = estimate[i].stamp_ns = kFirstStampNs + i * kIntervalNs;
    truth[i].world_from_body.translation = {0.2 * i, 0.0, 0.0};
    const double drift_rad = i * 0.1 * std::numbers::pi / 180.0;  // 0.1 degrees per pose
    estimate[i].world_from_body = {ExpRotation({0.0, 0.0, drift_rad}),
                                   truth[i].world_from_body.translation};
  }
  const TrajectoryMetrics metrics = CompareTrajectories(estimate, truth);
  EXPECT_LT(metrics.aligned->ate_se3_m, 1e-9);
  EXPECT_NEAR(metrics.relative->rotation_deg_per_m, 0.1 / 0.2, 1e-9);
  EXPECT_GT(metrics.relative->translation_pct, 1.0);
}

// A straight way of 30 m along x, whose heights the estimate gets wrong by 1 in 100.
TEST(CompareTrajectories, TellsHeightsAndTheDriftOverFixedLengths) {
  std::vector<TumPose> truth, estimate;
  for (int i = 0; i <= 300; ++i) {
    const double x = 0.1 * i, aside = 0.5 * std::sin(0.3 * x);  // so that no axis is left open
    truth.push_back({i * 100'000'000LL, {Eigen::Quaterniond::Identity(), {x, aside, 0.0}}});
    const double height = i < 150 ? 0.0 : 0.01 * (x - 15.0);
    estimate.push_back({i * 100'000'000LL, {Eigen::Quaterniond::Identity(), {x, aside, height}}});
  }
  const TrajectoryMetrics metrics = CompareTrajectories(estimate, truth);
  ASSERT_TRUE(metrics.height);
  // The alignment turns half of the bend away.
  EXPECT_NEAR(metrics.height->rms_m, metrics.aligned->ate_se3_m, 1e-4);
  EXPECT_GT(metrics.height->rms_m, 0.005);
  EXPECT_NEAR(metrics.height->drift_pct, 0.0, 0.02);
  ASSERT_EQ(metrics.drift.size(), 3U);  // 5, 10 and 25 m
  EXPECT_EQ(metrics.drift[1].segment_m, 10.0);
  // Half of the stretches of 10 m are on the slope, most others reach into it.
  EXPECT_GT(metrics.drift[1].translation_pct, 0.3);
  EXPECT_LT(metrics.drift[1].translation_pct, 1.0);
  EXPECT_EQ(DriftToJson(metrics)["segments"].size(), 3U);
  EXPECT_EQ(DriftToJson(metrics)["segments"][2]["segment_m"], 25.0);
  EXPECT_TRUE(DriftToJson(metrics).contains("height_rms_m"));
}

TEST(CompareTrajectories, CountsMissingFramesAsUncovered) {
  const Poses truth = Drive(50);
  Poses estimate = truth;
  estimate.erase(estimate.begin() + 10, estimate.begin() + 20);
  const TrajectoryMetrics metrics = CompareTrajectories(estimate, truth);
  EXPECT_EQ(metrics.frames, 40U);
  EXPECT_NEAR(metrics.coverage, 0.8, 1e-12);
  EXPECT_LT(metrics.aligned->ate_se3_m, 1e-9);
}

TEST(CompareTrajectories, MatchesWithinTheToleranceOnly) {
  const Poses truth = Drive(50);
  Poses late = truth;
  for (TumPose& pose : late) pose.stamp_ns += 15'000'000;
  EXPECT_EQ(CompareTrajectories(late, truth).coverage, 1.0);
  EXPECT_EQ(CompareTrajectories(late, truth, {.max_dt_s = 0.01}).coverage, 0.0);
  EXPECT_FALSE(CompareTrajectories(late, truth, {.max_dt_s = 0.01}).aligned);
}

TEST(CompareTrajectories, TakesPosesInAnyOrder) {
  const Poses truth = Drive(50);
  const Poses reversed(truth.rbegin(), truth.rend());
  EXPECT_EQ(ToJson(CompareTrajectories(reversed, truth)).dump(),
            ToJson(CompareTrajectories(truth, truth)).dump());
}

TEST(CompareTrajectories, AnswersWhereThereAreFewOrNoPoses) {
  const Poses truth = Drive(50);
  for (std::size_t count = 0; count < 3; ++count) {
    const Poses few(truth.begin(), truth.begin() + static_cast<std::ptrdiff_t>(count));
    for (const auto& metrics : {CompareTrajectories(few, truth), CompareTrajectories(truth, few),
                                CompareTrajectories(few, few)}) {
      const auto json = ToJson(metrics);
      EXPECT_EQ(json["error"], "fewer than 3 matched poses");
      EXPECT_FALSE(json.contains("scale"));
    }
    EXPECT_EQ(CompareTrajectories(few, truth).coverage, static_cast<double>(count) / 50.0);
  }
}

TEST(CompareTrajectories, LeavesOutWhatARigThatStandsStillDoesNotHave) {
  Poses still(10);
  for (int i = 0; i < 10; ++i) still[i].stamp_ns = kFirstStampNs + i * kIntervalNs;
  const auto json = ToJson(CompareTrajectories(still, still));
  EXPECT_EQ(json["extent_m"], 0.0);
  EXPECT_EQ(json["ate_se3_m"], 0.0);
  for (const char* key : {"ate_se3_pct", "ate_sim3_m", "scale", "scale_error_pct", "rpe_t_pct"}) {
    EXPECT_FALSE(json.contains(key)) << key;
  }
}

TEST(CompareTrajectories, MeasuresExtentFromTheFirstPose) {
  Poses estimate(3);
  for (int i = 0; i < 3; ++i) estimate[i].stamp_ns = 3 - i;  // the last one is the first in time
  estimate[0].world_from_body.translation = {1.0, 0.0, 0.0};
  estimate[1].world_from_body.translation = {-1.0, 0.0, 0.0};
  EXPECT_EQ(CompareTrajectories(estimate, estimate).extent_m, 1.0);
}

TEST(EvaluationOptions, RefusesNegativeValues) {
  EXPECT_THROW(RequireValid(EvaluationOptions{.max_dt_s = -1.0}), UsageError);
  EXPECT_THROW(RequireValid(EvaluationOptions{.segment_m = -1.0}), UsageError);
  EXPECT_NO_THROW(RequireValid(EvaluationOptions{}));
}

}  // namespace
}  // namespace rigmap
