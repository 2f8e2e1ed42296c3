#include "evaluation/height_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

SurfacePoint At(double x, double y, double z) {
  return {.x_in_world = Eigen::Vector3d(x, y, z).cast<float>()};
}

TEST(HeightGrid, KeepsTopAndMeanOfEachCell) {
  HeightGrid grid;
  grid.Add(std::vector{At(0.005, -0.005, 1.0), At(0.015, -0.015, 2.0)});
  grid.Add(std::vector{At(0.001, -0.001, 1.5)});
  const HeightCell* cell = grid.Find({0, -1});
  ASSERT_NE(cell, nullptr);
  EXPECT_EQ(cell->points, 3U);
  EXPECT_FLOAT_EQ(cell->top_m, 2.0F);
  EXPECT_NEAR(cell->mean_m, 1.5, 1e-6);
  EXPECT_EQ(grid.Find({1, -1}), nullptr);  // in the same tile, where no point fell
  EXPECT_EQ(grid.Find({500, 0}), nullptr);
}

TEST(HeightGrid, PassesOverWhatIsNotFinite) {
  HeightGrid grid;
  grid.Add(std::vector{At(std::nan(""), 0.0, 0.0), At(0.0, 2.0e6, 0.0), At(0.0, 0.0, INFINITY)});
  EXPECT_TRUE(grid.tiles().empty());
}

TEST(HeightGrid, CellsAndTilesAgree) {
  const TileIndex tile = TileOf({-0.01, 0.33});
  EXPECT_EQ(tile, TileIndex(-1, 1));
  for (std::size_t i = 0; i < HeightTile().size(); ++i) {
    EXPECT_EQ(TileOf(CentreOf(CellOfTile(tile, i))), tile);
  }
}

TEST(GroundLevel, IsTheSlopeBelowARock) {
  SeededRandom random;
  const auto ground_m = [](double x, double y) { return 0.1 * x - 0.05 * y + 3.0; };
  std::vector<SurfacePoint> points;
  for (double x = -2.0; x < 2.0; x += 0.02) {
    for (double y = -2.0; y < 2.0; y += 0.02) {
      const bool rock = std::hypot(x, y) < 0.4;
      points.push_back(At(x + 0.005, y + 0.005,
                          ground_m(x, y) + (rock ? 0.5 : 0.0) + random.Uniform(-0.003, 0.003)));
    }
  }
  HeightGrid grid;
  grid.Add(points);
  const GroundLevel level(grid);
  const auto at_rock = level.At({0.0, 0.0});
  ASSERT_TRUE(at_rock);
  EXPECT_NEAR(*at_rock, ground_m(0.0, 0.0), 0.01);
  EXPECT_FALSE(level.At({10.0, 0.0}));
  EXPECT_TRUE(level.Near({10.0, 0.0}));
  EXPECT_FALSE(GroundLevel(HeightGrid()).Near({0.0, 0.0}));
}

}  // namespace
}  // namespace rigmap
