#include "correspondence/patch_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

using Grey = std::function<double(const Eigen::Vector2d&)>;  // of a place in the first patch

// What a patch shows whose middle is at `offset` from the point, the ground being stretched.
Patch Show(const Grey& grey, const Eigen::Vector2d& offset,
           const Eigen::Matrix2d& stretched = Eigen::Matrix2d::Identity()) {
  Patch patch;
  for (int i = 0; i < kPatchSize * kPatchSize; ++i) {
    const Eigen::Vector2d from_middle(i % kPatchSize - kPatchRadius, i / kPatchSize - kPatchRadius);
    patch[i] =
        static_cast<std::uint8_t>(std::lround(grey(stretched.inverse() * (from_middle + offset))));
  }
  return patch;
}

// Waves of several lengths and directions: unlike itself anywhere near.
double Ground(const Eigen::Vector2d& at) {
  return 128.0 + 25.0 * std::sin(0.71 * at.x() + 0.2 * at.y()) +
         25.0 * std::sin(0.23 * at.x() - 0.53 * at.y() + 1.0) +
         25.0 * std::sin(0.9 * at.y() + 0.11 * at.x() * at.y() / 5.0 + 2.0);
}

double Ripples(const Eigen::Vector2d& at) {
  return 128.0 + 60.0 * std::sin(1.3 * at.x()) + 40.0 * std::sin(0.1 * at.y());
}

TEST(FindInPatch, FindsThePointWhereItIs) {
  const Patch source = Show(Ground, Eigen::Vector2d::Zero());
  for (const Eigen::Vector2d& shift :
       {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(5.3, -2.6), Eigen::Vector2d(-6.4, 6.2)}) {
    const auto found = FindInPatch({source}, Show(Ground, -shift));
    ASSERT_TRUE(found) << shift.transpose();
    EXPECT_LT((*found - shift).norm(), 0.2) << found->transpose();
  }
}

TEST(FindInPatch, StretchesThePatchAsItWasTold) {
  const Eigen::Matrix2d stretched = Eigen::Vector2d(1.25, 1.6).asDiagonal();
  const Eigen::Vector2d shift(3.4, 4.7), offset(0.3, -0.4);
  // The point is off the middle of the patch that it is searched by.
  const Patch source = Show(Ground, -offset);
  const auto found = FindInPatch({source, offset, stretched}, Show(Ground, -shift, stretched));
  ASSERT_TRUE(found);
  EXPECT_LT((*found - shift).norm(), 0.2) << found->transpose();
}

TEST(FindInPatch, FindsNothingOutOfReach) {
  const Patch source = Show(Ground, Eigen::Vector2d::Zero());
  const auto found = FindInPatch({source}, Show(Ground, Eigen::Vector2d(14.0, 13.0)));
  EXPECT_FALSE(found);
}

TEST(FindInPatch, FindsNothingThatIsThereTwice) {
  const Patch source = Show(Ripples, Eigen::Vector2d::Zero());
  EXPECT_FALSE(FindInPatch({source}, Show(Ripples, Eigen::Vector2d(1.0, 0.0))));
}

TEST(FindInPatch, FindsNothingInNoiseOrWhereAllIsGrey) {
  const Patch source = Show(Ground, Eigen::Vector2d::Zero());
  SeededRandom random;
  int found = 0;
  for (int i = 0; i < 50; ++i) {
    const Grey noise = [&](const Eigen::Vector2d&) { return 128.0 + random.Normal(20.0); };
    found += FindInPatch({source}, Show(noise, Eigen::Vector2d::Zero())).has_value() ? 1 : 0;
  }
  EXPECT_EQ(found, 0);
  const Grey flat = [](const Eigen::Vector2d&) { return 90.0; };
  EXPECT_FALSE(FindInPatch({source}, Show(flat, Eigen::Vector2d::Zero())));
  EXPECT_FALSE(FindInPatch({Show(flat, Eigen::Vector2d::Zero())}, source));
}

}  // namespace
}  // namespace rigmap
