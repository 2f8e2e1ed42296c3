#include "evaluation/matched_poses.h"

#include <gtest/gtest.h>

namespace rigmap {
namespace {

TumPose At(StampNs stamp_ns, double x) {
  return {stamp_ns, Rigid3{Eigen::Quaterniond::Identity(), Eigen::Vector3d(x, 0.0, 0.0)}};
}

TEST(MatchPoses, GivesEachTruePoseTheNearestInTime) {
  const std::vector<TumPose> estimate{At(0, 0.0), At(1'000'000'000, 1.0), At(2'000'000'000, 2.0)};
  const std::vector<TumPose> truth{At(900'000'000, 0.9), At(1'100'000'000, 1.1),
                                   At(2'400'000'000, 2.4)};
  const MatchedPoses matched = MatchPoses(estimate, truth, 0.2, Tie::kEarlier);
  ASSERT_EQ(matched.size(), 2U);  // the last is 0.4 s from any
  EXPECT_EQ(matched.estimate[0].translation.x(), 1.0);
  EXPECT_EQ(matched.estimate[1].translation.x(), 1.0);  // serves two
  EXPECT_EQ(matched.truth[1].translation.x(), 1.1);
}

TEST(MatchPoses, BreaksTiesAsAsked) {
  const std::vector<TumPose> estimate{At(0, 0.0), At(1'000'000'000, 1.0)};
  const std::vector<TumPose> truth{At(500'000'000, 0.5)};
  EXPECT_EQ(MatchPoses(estimate, truth, 1.0, Tie::kEarlier).estimate.at(0).translation.x(), 0.0);
  EXPECT_EQ(MatchPoses(estimate, truth, 1.0, Tie::kLater).estimate.at(0).translation.x(), 1.0);
}

TEST(MatchPoses, FindsNothingWithoutAnEstimate) {
  EXPECT_EQ(MatchPoses({}, {At(0, 0.0)}, 1.0, Tie::kEarlier).size(), 0U);
}

TEST(InOrderOfTime, KeepsTheOrderOfEqualStamps) {
  const std::vector<TumPose> poses{At(2, 0.0), At(1, 1.0), At(2, 2.0)};
  const auto sorted = InOrderOfTime(poses);
  EXPECT_EQ(sorted[0].world_from_body.translation.x(), 1.0);
  EXPECT_EQ(sorted[1].world_from_body.translation.x(), 0.0);
  EXPECT_EQ(sorted[2].world_from_body.translation.x(), 2.0);
}

}  // namespace
}  // namespace rigmap
