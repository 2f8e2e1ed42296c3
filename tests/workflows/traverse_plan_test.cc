#include "workflows/traverse_plan.h"

#include <gmock/gmock.h>

namespace rigmap {
namespace {

TraversePlan PlanOf(int jobs, int pairs, double megapixels) {
  TraversePlan plan;
  plan.jobs.assign(static_cast<std::size_t>(jobs), {.pairs = pairs, .megapixels = megapixels});
  return plan;
}

TEST(PartsAtOnceTest, AreAsManyAsThereAreThreadsOrParts) {
  EXPECT_EQ(PartsAtOnce(PlanOf(10, 50, 0.2), 1, 2048), 1);
  EXPECT_EQ(PartsAtOnce(PlanOf(10, 50, 0.2), 4, 2048), 4);
  EXPECT_EQ(PartsAtOnce(PlanOf(3, 50, 0.2), 4, 2048), 3);
  EXPECT_EQ(PartsAtOnce(PlanOf(0, 0, 0.0), 4, 2048), 1);
}

TEST(PartsAtOnceTest, FitIntoTheMemory) {
  // 150 MB, 1 MB a pair, 250 MB a megapixel: 450 MB each.
  EXPECT_EQ(PartsAtOnce(PlanOf(10, 50, 1.0), 16, 2048), 4);
  EXPECT_EQ(PartsAtOnce(PlanOf(10, 50, 1.0), 8, 8192), 8);
  EXPECT_EQ(PartsAtOnce(PlanOf(10, 50, 12.0), 16, 2048), 1);
}

using Cuts = std::vector<std::pair<int, int>>;

TEST(CutEvenlyTest, NeighboursShareTheOverlapAndNoMore) {
  EXPECT_EQ(CutEvenly(8, 2, 1), (Cuts{{0, 5}, {4, 8}}));
  EXPECT_EQ(CutEvenly(100, 3, 10), (Cuts{{0, 40}, {30, 70}, {60, 100}}));
  EXPECT_EQ(CutEvenly(100, 1, 10), (Cuts{{0, 100}}));
}

TEST(PiecesOfAtMostTest, AreAsFewAsKeepToTheLimitWithWhatTheyShare) {
  EXPECT_EQ(PiecesOfAtMost(51, 101, 10), 3);
  EXPECT_EQ(PiecesOfAtMost(56, 101, 10), 2);
  EXPECT_EQ(PiecesOfAtMost(101, 101, 10), 1);
  for (int pairs = 1; pairs < 300; ++pairs) {
    for (const int most : {21, 22, 37, 60, 150}) {
      const int pieces = PiecesOfAtMost(most, pairs, 10);
      int longest = 0;
      for (const auto& [begin, end] : CutEvenly(pairs, pieces, 10)) {
        longest = std::max(longest, end - begin);
      }
      EXPECT_LE(longest, most) << pairs;
      if (pieces == 1) continue;
      const auto fewer = CutEvenly(pairs, pieces - 1, 10);
      EXPECT_TRUE(std::ranges::any_of(fewer, [&](const auto& cut) {
        return cut.second - cut.first > most;
      })) << pairs;
    }
  }
}

TEST(EstimatedJoinSecondsTest, GrowWithThePairsAndShrinkWithTheThreads) {
  const double one = EstimatedJoinSeconds(PlanOf(1, 500, 0.8), 1);
  EXPECT_GT(one, EstimatedJoinSeconds(PlanOf(1, 500, 0.8), 2));
  EXPECT_LT(one, EstimatedJoinSeconds(PlanOf(2, 500, 0.8), 1));
}

}  // namespace
}  // namespace rigmap
