#include "matching/internal/find_loop_closures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/matching/circling_rover.h"
#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

TEST(FindLoopClosures, FindsWhatTheOdometryDoesNotKnow) {
  const SyntheticRover rover = CircleAndOn();
  const Odometry odometry = Drifting(rover);
  MatchingOptions blind;
  blind.revisit_candidates = 0;
  EXPECT_TRUE(MatchRover(rover, odometry, blind).loop_closures.empty());
  const Correspondences found = MatchRover(rover, odometry);
  ASSERT_GE(found.loop_closures.size(), 3u);
  for (const LoopClosure& loop_closure : found.loop_closures) {
    EXPECT_TRUE(loop_closure.by_appearance);
    EXPECT_LT(loop_closure.a, loop_closure.b);
    const Rigid3 error = loop_closure.b_from_a * TrueMotion(rover, loop_closure).Inverse();
    EXPECT_LT(error.translation.norm(), 0.02) << loop_closure.a << " " << loop_closure.b;
    EXPECT_LT(AngleOf(error.rotation), 0.005);
    const auto pair = std::ranges::find_if(found.pairs, [&](const FramePair& p) {
      return p.a == loop_closure.a && p.b == loop_closure.b;
    });
    ASSERT_NE(pair, found.pairs.end());
    int right = 0;
    for (const auto& [a, b] : pair->matches) {
      right += rover.point_of_feature[pair->a][a] == rover.point_of_feature[pair->b][b] ? 1 : 0;
    }
    EXPECT_GT(right, 0.98 * static_cast<double>(pair->matches.size()));
  }
}

TEST(FindLoopClosures, NoPairIsMatchedTwice) {
  const SyntheticRover rover = CircleAndOn();
  // Without drift odometry and appearance lead to the same places.
  const Correspondences found =
      MatchRover(rover, OdometryOfKeyframes(rover, rover.world_from_left));
  std::vector<std::pair<int, int>> pairs;
  for (const FramePair& pair : found.pairs) pairs.emplace_back(pair.a, pair.b);
  std::ranges::sort(pairs);
  EXPECT_EQ(std::ranges::adjacent_find(pairs), pairs.end());
  EXPECT_FALSE(found.loop_closures.empty());
}

TEST(FindLoopClosures, ASimilarViewElsewhereIsNotBelieved) {
  SeededRandom random;
  SyntheticRover rover = CircleAndOn();
  // The last frames look like others, but all that looks alike lies somewhere else.
  for (int frame = 18; frame < 23; ++frame) {
    auto& descriptors = rover.frames[frame].descriptors;
    const auto& others = rover.frames[frame - 10].descriptors;
    for (auto& descriptor : descriptors) {
      descriptor =
          others[static_cast<std::size_t>(random.Uniform(0.0, static_cast<double>(others.size())))];
    }
  }
  for (const LoopClosure& loop_closure : MatchRover(rover, Drifting(rover)).loop_closures) {
    EXPECT_LT(loop_closure.b, 18) << loop_closure.a;
  }
}

// Far ahead is ground that frames a dozen later pass.
TEST(FindLoopClosures, AreTrueOnAStraightWay) {
  SeededRandom random;
  const SyntheticRover rover = MakeSyntheticRover({.frames = 20,
                                                   .step_m = 0.4,
                                                   .curve_rad_per_m = 0.0,
                                                   .points_per_m2 = 8.0,
                                                   .textured_patches = true});
  const Odometry odometry = OdometryOfKeyframes(rover, DriftingPoses(rover, 0.004, 0.002, random));
  const auto found = MatchRover(rover, odometry).loop_closures;
  ASSERT_FALSE(found.empty());
  for (const LoopClosure& loop_closure : found) {
    const Rigid3 true_motion =
        rover.world_from_left[loop_closure.b].Inverse() * rover.world_from_left[loop_closure.a];
    EXPECT_LT((loop_closure.b_from_a * true_motion.Inverse()).translation.norm(), 0.05);
  }
}

}  // namespace
}  // namespace rigmap
