#include "fusion/merge_clouds.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/seeded_random.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

SurfacePoint PointAt(const Eigen::Vector3f& x_in_world, float sigma_m) {
  return {.x_in_world = x_in_world,
          .normal = Eigen::Vector3f::UnitZ(),
          .rgb = {10, 20, 30},
          .observations = 1,
          .sigma_m = sigma_m};
}

PointCloud Merged(const std::vector<PointCloud>& clouds, double grid_m) {
  const TemporaryFolder folder;
  PointCloud merged;
  const auto take = [&](std::span<const SurfacePoint> points) {
    merged.insert(merged.end(), points.begin(), points.end());
  };
  MergeClouds(clouds.size(), [&](std::size_t i) { return clouds[i]; }, grid_m,
              {folder.Path() / "tiles", take});
  return merged;
}

TEST(MergeClouds, GivesTheWeightedMeanOfEachCube) {
  const auto merged =
      Merged({{PointAt({0.01F, 0.01F, 0.01F}, 0.01F)},
              {PointAt({0.04F, 0.01F, 0.01F}, 0.02F), PointAt({1.01F, 0.01F, 0.01F}, 0.01F)}},
             0.05);
  ASSERT_EQ(merged.size(), 2U);
  // Weights of 4 and 1.
  EXPECT_NEAR(merged[0].x_in_world.x(), 0.016F, 1e-5);
  EXPECT_EQ(merged[0].observations, 2);
  EXPECT_FLOAT_EQ(merged[0].grain_m, 0.05F);
}

TEST(MergeClouds, ChangesLittleWithTheOrderAndNothingWhenRepeated) {
  SeededRandom random;
  std::vector<PointCloud> clouds(5);
  for (PointCloud& cloud : clouds) {
    for (int i = 0; i < 2000; ++i)
      cloud.push_back(PointAt(random.Vector(1.0).cast<float>(), 0.01F));
  }
  const PointCloud first = Merged(clouds, 0.1), again = Merged(clouds, 0.1);
  std::ranges::reverse(clouds);
  const PointCloud reversed = Merged(clouds, 0.1);
  ASSERT_EQ(first.size(), reversed.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].x_in_world, again[i].x_in_world);
    EXPECT_LT((first[i].x_in_world - reversed[i].x_in_world).norm(), 1e-5F);
  }
}

TEST(MergeClouds, OfNothingIsNothing) { EXPECT_TRUE(Merged({}, 0.05).empty()); }

}  // namespace
}  // namespace rigmap
