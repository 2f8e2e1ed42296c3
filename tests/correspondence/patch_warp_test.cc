#include "correspondence/patch_warp.h"

#include <gtest/gtest.h>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

TEST(PatchWarp, OfAMapOfSecondOrderIsThatMap) {
  SeededRandom random;
  for (int i = 0; i < 100; ++i) {
    PatchWarp truth{.position = random.Noise(100.0).head<2>()};
    for (double& entry : truth.linear.reshaped()) entry += random.Uniform(-0.3, 0.3);
    for (double& entry : truth.bend.reshaped()) entry = random.Uniform(-0.01, 0.01);
    const auto warp = WarpOf([&](const Eigen::Vector2d& offset) { return truth * offset; });
    ASSERT_TRUE(warp);
    EXPECT_LT((warp->position - truth.position).norm(), 1e-9);
    EXPECT_LT((warp->linear - truth.linear).norm(), 1e-9);
    EXPECT_LT((warp->bend - truth.bend).norm(), 1e-9);
  }
}

TEST(PatchWarp, IsNoneOfWhatHasNoNumbersOrIsSingular) {
  EXPECT_FALSE(
      WarpOf([](const Eigen::Vector2d&) { return Eigen::Vector2d::Constant(NAN).eval(); }));
  EXPECT_FALSE(WarpOf(
      [](const Eigen::Vector2d& offset) { return Eigen::Vector2d(offset.x(), offset.x()); }));
}

}  // namespace
}  // namespace rigmap
