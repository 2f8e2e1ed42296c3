#include "raster/internal/point_cells.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "tests/raster/synthetic_map.h"
#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

constexpr double kTurnedCell_m = 0.02;

GridFrame TurnedGrid(double angle_rad, const Eigen::Vector2d& shift) {
  GridFrame grid{.epsg = 32631};
  grid.grid_from_world = Eigen::Translation2d(shift) * Eigen::Rotation2Dd(angle_rad);
  return grid;
}

using Cells = std::set<std::pair<int, int>>;

Cells CellsOf(const PointCells& cells, const SurfacePoint& point) {
  Cells taken;
  cells.ForEach(point, [&](int column, int row) { taken.emplace(column, row); });
  return taken;
}

TEST(PointCells, InTheWorldAreTheCellsOfThePointsCube) {
  const PointCells cells({kTurnedCell_m, -50, 49, 100, 100}, std::nullopt);
  SurfacePoint point = MapPoint(0.011, 0.031, 0.0);
  EXPECT_EQ(CellsOf(cells, point), (Cells{{50, 48}}));
  point.grain_m = static_cast<float>(3 * kTurnedCell_m);
  EXPECT_EQ(CellsOf(cells, point).size(), 9U);
  // From 0 to 0.06 m either way: columns 50 to 52 and rows 49 to 47.
  EXPECT_EQ(*CellsOf(cells, point).begin(), std::pair(50, 47));
}

TEST(PointCells, OnAGridThatIsTheWorldsAreTheSame) {
  const CellFrame frame{kTurnedCell_m, -50, 49, 100, 100};
  const PointCells world(frame, std::nullopt), grid(frame, TurnedGrid(0.0, {0.0, 0.0}));
  SeededRandom random;
  for (int i = 0; i < 200; ++i) {
    SurfacePoint point = MapPoint(random.Uniform(-1.0, 1.0), random.Uniform(-1.0, 1.0), 0.0);
    point.grain_m = static_cast<float>(kTurnedCell_m * (1 + i % 5));
    EXPECT_EQ(CellsOf(world, point), CellsOf(grid, point));
  }
}

// Whatever the map is turned by, each of its cells is given the point of one cell of the world: no
// holes, nothing twice.
TEST(PointCells, OnATurnedGridEachCellTakesOneOfTheWorlds) {
  SeededRandom random;
  for (int run = 0; run < 10; ++run) {
    const Eigen::Vector2d shift(5e5 + random.Uniform(0.0, 1.0), 5.7e6 + random.Uniform(0.0, 1.0));
    const GridFrame grid = TurnedGrid(random.Uniform(-3.0, 3.0), shift);
    // A metre around the world's origin, well inside the points.
    const CellFrame frame{kTurnedCell_m, static_cast<std::int64_t>(shift.x() / kTurnedCell_m) - 20,
                          static_cast<std::int64_t>(shift.y() / kTurnedCell_m) + 20, 40, 40};
    const PointCells cells(frame, grid);
    std::map<std::pair<int, int>, int> taken;
    for (int i = -60; i < 60; ++i) {
      for (int j = -60; j < 60; ++j) {
        const double x = (i + random.Uniform(0.01, 0.99)) * kTurnedCell_m;
        const SurfacePoint point =
            MapPoint(x, (j + random.Uniform(0.01, 0.99)) * kTurnedCell_m, 0.0);
        cells.ForEach(point, [&](int column, int row) {
          ++taken[{column, row}];
          const Eigen::Vector2d off =
              cells.InWorld(column, row) - point.x_in_world.head<2>().cast<double>();
          EXPECT_LT(off.cwiseAbs().maxCoeff(), kTurnedCell_m * 1.001);
        });
      }
    }
    EXPECT_EQ(taken.size(), 1600U);
    for (const auto& [cell, count] : taken) EXPECT_EQ(count, 1);
  }
}

}  // namespace
}  // namespace rigmap
