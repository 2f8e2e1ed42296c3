// The metrics of trajectories against a scorer that was written apart from this project.
#include "tests/evaluation/reference_scorer.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "evaluation/trajectory_metrics.h"
#include "tests/support/seeded_random.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_file.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

// One unit of the last digit that is printed under `key`.
double LastPrintedDigit(const std::string& key) {
  if (key == "frames" || key == "gt_frames") return 0.0;
  if (key == "coverage" || key == "ate_se3_pct" || key == "rpe_t_pct") return 1e-4;
  if (key == "path_m" || key == "est_path_m" || key == "segment_m" || key == "scale_error_pct") {
    return 1e-3;
  }
  return 1e-5;
}

void ExpectAlike(const ordered_json& found, const ordered_json& expected) {
  ASSERT_EQ(found.size(), expected.size()) << found << "\n" << expected;
  auto it = found.begin();
  for (const auto& [key, value] : expected.items()) {
    ASSERT_EQ(it.key(), key) << found << "\n" << expected;
    if (value.is_number()) {
      const double difference = std::abs(it->get<double>() - value.get<double>());
      EXPECT_LE(difference, 1.001 * LastPrintedDigit(key)) << key << "\n"
                                                           << found << "\n"
                                                           << expected;
    } else {
      EXPECT_EQ(*it, value);
    }
    ++it;
  }
}

class ReferenceScorer : public ReferenceScorerTest {
 protected:
  void Compare(const fs::path& estimate, const fs::path& truth,
               const EvaluationOptions& options = {}) {
    std::string command = fmt::format("{} '{}' '{}' '{}' --max-dt {}", kPython,
                                      Scorer("trajectory_metrics.py").string(), estimate.string(),
                                      truth.string(), options.max_dt_s);
    if (options.segment_m > 0.0) command += fmt::format(" --segment {}", options.segment_m);
    const auto metrics = CompareTrajectories(ReadTum(estimate), ReadTum(truth), options);
    ExpectAlike(ToJson(metrics), ordered_json::parse(OutputOf(command)));
  }

  // A random drive of the length of a part.
  Trajectory Drive(int count) {
    Trajectory trajectory(count);
    Rigid3 world_from_left = random_.Motion(50.0);
    for (int i = 0; i < count; ++i) {
      trajectory[i].stamp_ns = 1448551416619000000 + i * 300'000'000LL;
      trajectory[i].world_from_left = world_from_left;
      const Eigen::Vector3d step_m(0.0, 0.0, random_.Uniform(0.05, 0.3));
      world_from_left =
          world_from_left * Rigid3{random_.Rotation(0.1), step_m + random_.Noise(0.01)};
    }
    return trajectory;
  }

  // What an estimator would make of it: another world, noise, a scale a little off, late stamps and
  // some frames lost.
  Trajectory Estimate(const Trajectory& truth, double noise_m, double lost_share) {
    Sim3 other_from_world = random_.Similarity(10.0);
    other_from_world.scale = random_.Uniform(0.97, 1.03);
    Trajectory estimate;
    for (TimedPose pose : truth) {
      if (random_.Uniform(0.0, 1.0) < lost_share) continue;
      pose.world_from_left = TransformPose(other_from_world, pose.world_from_left) *
                             Rigid3{random_.Rotation(0.01), random_.Noise(noise_m)};
      pose.stamp_ns += static_cast<StampNs>(random_.Uniform(-3e7, 3e7));
      estimate.push_back(pose);
    }
    return estimate;
  }

  void Compare(const Trajectory& estimate, const Trajectory& truth,
               const EvaluationOptions& options = {}) {
    const TemporaryFolder folder;
    Compare(WriteTestFile(folder.Path() / "estimate.tum", WriteTum(estimate)),
            WriteTestFile(folder.Path() / "truth.tum", WriteTum(truth)), options);
  }

  SeededRandom random_;
};

TEST_F(ReferenceScorer, AgreesOnNoisyDrives) {
  for (const int count : {20, 150}) {
    const Trajectory truth = Drive(count);
    Compare(Estimate(truth, 0.05, 0.2), truth, {.max_dt_s = 0.025});
  }
}

TEST_F(ReferenceScorer, AgreesOnOtherSegmentsAndTolerances) {
  const Trajectory truth = Drive(80);
  Compare(Estimate(truth, 0.02, 0.1), truth, {.max_dt_s = 0.5, .segment_m = 1.7});
}

TEST_F(ReferenceScorer, AgreesOnAPerfectTrajectory) {
  const Trajectory truth = Drive(30);
  Compare(truth, truth);
}

// Steps of equal length, and estimates half-way between two true poses: every tie there can be.
TEST_F(ReferenceScorer, AgreesOnTies) {
  Trajectory truth(41), estimate;
  for (int i = 0; i < 41; ++i) {
    truth[i].stamp_ns = i * 1'000'000'000LL;
    truth[i].world_from_left.translation = {0.1 * i, 0.3 * std::sin(i), 0.0};
    TimedPose between = truth[i];
    between.stamp_ns += 500'000'000LL;
    estimate.push_back(between);
  }
  Compare(estimate, truth, {.max_dt_s = 0.5});
  for (auto& pose : truth) pose.world_from_left.translation.y() = 0.0;
  Compare(estimate, truth, {.max_dt_s = 0.5});
}

TEST_F(ReferenceScorer, AgreesWhereTooFewPosesMatch) {
  const Trajectory truth = Drive(30);
  Compare({truth[3]}, truth);
  Compare({truth[3], truth[9]}, truth);
  Compare(truth, {truth[3], truth[9]});
}

TEST_F(ReferenceScorer, AgreesOnARealTrajectory) {
  const fs::path truth = data_ / "euroc-still/groundtruth_tum.txt";
  if (!fs::exists(truth)) GTEST_SKIP() << truth << " does not exist";
  Trajectory estimate;
  for (const TumPose& pose : ReadTum(truth)) {
    TimedPose noisy;
    noisy.stamp_ns = pose.stamp_ns;
    noisy.world_from_left =
        pose.world_from_body * Rigid3{random_.Rotation(0.01), random_.Noise(1e-3)};
    estimate.push_back(noisy);
  }
  const TemporaryFolder folder;
  Compare(WriteTestFile(folder.Path() / "estimate.tum", WriteTum(estimate)), truth);
}

}  // namespace
}  // namespace rigmap
