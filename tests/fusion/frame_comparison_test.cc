#include "fusion/internal/frame_comparison.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::Gt;
using testing::IsEmpty;
using testing::SizeIs;

// Looks along the world's z.
Rigid3 At(double z_m) { return {Eigen::Quaterniond::Identity(), {0.0, 0.0, z_m}}; }

std::vector<Rigid3> Row(int frames) {
  std::vector<Rigid3> poses;
  for (int i = 0; i < frames; ++i) poses.push_back(At(0.17 * i + 0.001 * i * i));
  return poses;
}

TEST(CompareWith, TakesTheNearestFirst) {
  SeededRandom random;
  std::vector<Rigid3> poses;
  for (int i = 0; i < 50; ++i) {
    poses.push_back({Eigen::Quaterniond::Identity(), random.Vector(1.0)});
  }
  FusionOptions options;
  options.ahead = 0;
  const auto near = CompareWith(7, poses, options).near;
  ASSERT_THAT(near, SizeIs(options.neighbours));
  const auto distance_m = [&](std::size_t i) {
    return (poses[i].translation - poses[7].translation).norm();
  };
  double last_m = 0.0;
  for (const std::size_t i : near) {
    EXPECT_NE(i, 7U);
    EXPECT_GE(distance_m(i), last_m);
    last_m = distance_m(i);
  }
  int nearer = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) nearer += i != 7 && distance_m(i) <= last_m;
  EXPECT_EQ(nearer, options.neighbours);
}

TEST(CompareWith, LooksAheadForwardAndEverMoreApart) {
  FusionOptions options;
  options.neighbours = 4;
  const FrameComparison compared = CompareWith(30, Row(60), options);
  EXPECT_THAT(compared.near, testing::UnorderedElementsAre(28, 29, 31, 32));
  ASSERT_THAT(compared.ahead, SizeIs(options.ahead));
  EXPECT_THAT(compared.ahead, Each(Gt(32U)));
  EXPECT_EQ(compared.ahead.front(), 33U);
  std::size_t last_gap = 0;
  for (std::size_t i = 1; i < compared.ahead.size(); ++i) {
    const std::size_t gap = compared.ahead[i] - compared.ahead[i - 1];
    EXPECT_GE(gap, last_gap);
    last_gap = gap;
  }
  EXPECT_GT(last_gap, 4U);
  EXPECT_NEAR(static_cast<double>(compared.ahead.back()), 50.0, 3.0) << "twenty frames ahead";
}

TEST(CompareWith, FindsNothingAheadOfTheLast) {
  const FrameComparison compared = CompareWith(59, Row(60), {});
  EXPECT_THAT(compared.near, SizeIs(FusionOptions{}.neighbours));
  EXPECT_THAT(compared.ahead, IsEmpty());
}

TEST(CompareWith, LeavesOutFramesThatLookElsewhere) {
  std::vector<Rigid3> poses = Row(5);
  const auto turn = [&](std::size_t frame, double angle_deg) {
    poses[frame].rotation =
        ExpRotation({0.0, angle_deg * std::numbers::pi / 180.0, 0.0}) * poses[frame].rotation;
  };
  turn(1, 61.0);
  turn(3, 59.0);
  turn(4, 180.0);
  EXPECT_THAT(CompareWith(2, poses, {}).near, testing::UnorderedElementsAre(0, 3));
  FusionOptions nearest_only;
  nearest_only.neighbours = 0;
  turn(3, 2.0);
  EXPECT_THAT(CompareWith(0, poses, nearest_only).ahead, ElementsAre(2));
}

TEST(CompareWith, KeepsToItsNumbers) {
  FusionOptions options;
  options.neighbours = 3;
  options.ahead = 2;
  const FrameComparison compared = CompareWith(5, Row(40), options);
  EXPECT_THAT(compared.near, SizeIs(3));
  EXPECT_THAT(compared.ahead, SizeIs(2));
  options.neighbours = options.ahead = 0;
  const FrameComparison none = CompareWith(5, Row(40), options);
  EXPECT_THAT(none.near, IsEmpty());
  EXPECT_THAT(none.ahead, IsEmpty());
  EXPECT_THAT(CompareWith(0, Row(1), {}).near, IsEmpty());
}

}  // namespace
}  // namespace rigmap
