#include "workflows/traverse_plan.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace rigmap
