#include "raster/footprint.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "raster/slope_statistics.h"
#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr float kUnseenBlock = std::numeric_limits<float>::quiet_NaN();

// A plane with this gradient, roughness and noise over 13 x 13 blocks of 8 cm.
GroundBlocks PlaneOfBlocks(const Eigen::Vector2d& gradient, double roughness_m, double sigma_m,
                           SeededRandom& random) {
  GroundBlocks blocks{13, 13, 0.08, {}, {}};
  for (int row = 0; row < blocks.rows; ++row) {
    for (int column = 0; column < blocks.columns; ++column) {
      const Eigen::Vector2d x = 0.08 * Eigen::Vector2d(column - 6, 6 - row);
      blocks.height_m.push_back(static_cast<float>(
          100.0 + gradient.dot(x) + random.Normal(roughness_m) + random.Normal(sigma_m)));
      blocks.sigma_m.push_back(static_cast<float>(sigma_m));
    }
  }
  return blocks;
}

TEST(GroundUnder, FindsTheSlopeOfAPlaneAndNoRoughnessOnIt) {
  SeededRandom random;
  const GroundBlocks blocks = PlaneOfBlocks({0.3, -0.4}, 0.0, 0.0, random);
  const auto ground = GroundUnder(blocks, 6, 6, {0.5, 15.0 * kDegree, 0.0});
  ASSERT_TRUE(ground);
  EXPECT_NEAR(ground->slope_rad, std::atan(0.5), 1e-4);
  EXPECT_LT(ground->roughness_m, 1e-4);
  EXPECT_NEAR(ground->step_height_m, 0.4 * 2 * 0.08, 1e-4);  // over two blocks
  EXPECT_NEAR(ground->steeper, 1.0, 1e-9);
}

TEST(GroundUnder, MeasuresAStoneAboveThePlane) {
  SeededRandom random;
  GroundBlocks blocks = PlaneOfBlocks({0.1, 0.0}, 0.0, 0.001, random);
  blocks.height_m[blocks.Index(7, 5)] += 0.25F;
  const auto ground = GroundUnder(blocks, 6, 6, {0.5, 15.0 * kDegree, 0.0});
  ASSERT_TRUE(ground);
  EXPECT_NEAR(ground->step_height_m, 0.25, 0.02);  // m
  EXPECT_GT(ground->roughness_m, 0.02);
  EXPECT_NEAR(ground->slope_rad, std::atan(0.1), 1.0 * kDegree);
}

TEST(GroundUnder, SaysNothingOfGroundThatWasHardlySeen) {
  SeededRandom random;
  GroundBlocks blocks = PlaneOfBlocks({0.1, 0.0}, 0.0, 0.001, random);
  for (int i = 0; i < 5 * 13; ++i) blocks.height_m[i] = kUnseenBlock;
  EXPECT_FALSE(GroundUnder(blocks, 6, 6, {0.5, 15.0 * kDegree, 0.0}));
  EXPECT_FALSE(GroundUnder(blocks, 0, 6, {0.5, 15.0 * kDegree, 0.0})) << "beyond the edge";
}

// Monte Carlo: gradients drawn about the limit, measured, and asked for the probability; among
// those that were given p, a share of p is steeper. And the gradient's normalised errors are as
// they say.
TEST(GroundUnder, ProbabilitiesAreSharesOfWhatIsSteeper) {
  SeededRandom random;
  constexpr int kRuns = 8000, kBins = 5;
  std::array<double, kBins> stated{}, steeper{}, count{};
  const FootprintLimits limits{0.4, 15.0 * kDegree, 0.02};
  for (int run = 0; run < kRuns; ++run) {
    // Even over a square much wider than the sigmas, about a point on the circle of the limit.
    const Eigen::Vector2d truth(std::tan(limits.max_slope_rad) + random.Uniform(-0.25, 0.25),
                                random.Uniform(-0.25, 0.25));
    const Eigen::Vector2d lean(random.Normal(0.02), random.Normal(0.02));
    const GroundBlocks blocks = PlaneOfBlocks(truth + lean, 0.01, 0.02, random);
    const auto ground = GroundUnder(blocks, 6, 6, limits);
    ASSERT_TRUE(ground);
    const auto bin = std::min(static_cast<int>(ground->steeper * kBins), kBins - 1);
    stated[bin] += ground->steeper;
    steeper[bin] += truth.norm() > std::tan(limits.max_slope_rad) ? 1.0 : 0.0;
    count[bin] += 1.0;
  }
  for (int bin = 0; bin < kBins; ++bin) {
    ASSERT_GT(count[bin], 100.0);
    const double share = stated[bin] / count[bin];
    const double chance = 4.0 * std::sqrt(share * (1.0 - share) / count[bin]);
    EXPECT_NEAR(steeper[bin] / count[bin], share, chance + 0.02) << "bin " << bin;
  }
}

TEST(ProbabilityOfSteeper, IsTheShareOfDrawsOutsideTheCircle) {
  SeededRandom random;
  for (int run = 0; run < 30; ++run) {
    Eigen::Matrix2d root;
    root << random.Uniform(0.001, 0.2), 0.0, random.Uniform(-0.1, 0.1), random.Uniform(0.001, 0.2);
    const Eigen::Vector2d mean(random.Uniform(-0.5, 0.5), random.Uniform(-0.5, 0.5));
    const double limit_rad = random.Uniform(5.0, 30.0) * kDegree;
    constexpr int kDraws = 20000;
    int steeper = 0;
    for (int i = 0; i < kDraws; ++i) {
      const double x = random.Normal(1.0);
      const Eigen::Vector2d drawn = mean + root * Eigen::Vector2d(x, random.Normal(1.0));
      steeper += drawn.norm() > std::tan(limit_rad) ? 1 : 0;
    }
    // 4.5 sigmas of so many draws, and what the sum of twelve uniform numbers is not normal by.
    EXPECT_NEAR(ProbabilityOfSteeper(mean, root * root.transpose(), limit_rad),
                static_cast<double>(steeper) / kDraws, 4.5 * 0.5 / std::sqrt(kDraws) + 0.003);
  }
}

TEST(ProbabilityOfSteeper, IsSureWithoutUncertainty) {
  const Eigen::Matrix2d none = Eigen::Matrix2d::Zero();
  EXPECT_NEAR(ProbabilityOfSteeper({0.26, 0.0}, none, 15.0 * kDegree), 0.0, 1e-9);
  EXPECT_NEAR(ProbabilityOfSteeper({0.0, 0.28}, none, 15.0 * kDegree), 1.0, 1e-9);
  // On the level, alike in all directions: Rayleigh.
  const double sigma = 0.1, limit_rad = 15.0 * kDegree;
  EXPECT_NEAR(
      ProbabilityOfSteeper({0.0, 0.0}, sigma * sigma * Eigen::Matrix2d::Identity(), limit_rad),
      std::exp(-0.5 * std::pow(std::tan(limit_rad) / sigma, 2.0)), 1e-7);
}

TEST(BlocksOf, AreMeansOfTheirCells) {
  const float n = kUnseenBlock;
  const GroundBlocks blocks = BlocksOf({1, 2, n, n,  //
                                        3, 4, n, 7},
                                       {0.1F, 0.1F, n, n, 0.1F, 0.1F, n, 0.2F}, 4, 2, 0.01);
  EXPECT_EQ(blocks.columns, 2);
  EXPECT_EQ(blocks.rows, 1);
  EXPECT_DOUBLE_EQ(blocks.block_m, 0.02);
  EXPECT_FLOAT_EQ(blocks.height_m[0], 2.5F);
  EXPECT_FLOAT_EQ(blocks.sigma_m[0], 0.1F);
  EXPECT_FLOAT_EQ(blocks.height_m[1], 7.0F);
}

}  // namespace
}  // namespace rigmap
