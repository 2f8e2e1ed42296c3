#include "simulation/sand_tiles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "simulation/internal/world_parts.h"
#include "tests/simulation/small_world.h"
#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

constexpr int kCells = SandTiles::kCells;

const SandTiles& Tiles() { return SmallWorld().parts().tiles; }
double SideOf(const SandTile& tile) { return kCells * tile.cell_m; }
bool Holds(const SandTile& tile, const Eigen::Vector2d& position) {
  const Eigen::Array2d at = (position - tile.corner).array() / SideOf(tile);
  return (at >= 0.0).all() && (at < 1.0).all();
}

TEST(SandTiles, CoverASquareOnce) {
  Eigen::AlignedBox2d square;
  double area_m2 = 0.0;
  for (const SandTile& tile : Tiles().tiles()) {
    square.extend(tile.corner);
    square.extend((tile.corner.array() + SideOf(tile)).matrix().eval());
    area_m2 += SideOf(tile) * SideOf(tile);
  }
  EXPECT_NEAR(area_m2, square.volume(), 1e-9 * area_m2);
  EXPECT_GE(square.sizes().minCoeff(), 1200.0);
  EXPECT_TRUE(square.contains(Eigen::Vector2d(-600.0, -600.0)));
  SeededRandom random;
  for (int i = 0; i < 2000; ++i) {
    const double reach_m = i % 2 ? 10.0 : 640.0;
    const Eigen::Vector2d position = random.Vector(reach_m).head<2>();
    const auto holding = std::ranges::count_if(
        Tiles().tiles(), [&](const auto& tile) { return Holds(tile, position); });
    ASSERT_EQ(holding, 1) << position.transpose();
    EXPECT_TRUE(Holds(Tiles().tiles()[Tiles().TileAt(position)], position));
  }
}

TEST(SandTiles, PositionsOutsideAreTakenToTheNearestEdge) {
  EXPECT_EQ(Tiles().TileAt({5000.0, 30.0}), Tiles().TileAt({600.0, 30.0}));
  EXPECT_EQ(Tiles().TileAt({30.0, -5000.0}), Tiles().TileAt({30.0, -600.0}));
  EXPECT_EQ(Tiles().TileAt({-5000.0, 5000.0}), Tiles().TileAt({-600.0, 600.0}));
}

TEST(SandTiles, CellsAreFineNearTheOutlineAndLieOnTheirMultiples) {
  int finest = 0;
  for (const SandTile& tile : Tiles().tiles()) {
    const double doublings = std::log2(tile.cell_m / kSmallCell_m);
    EXPECT_NEAR(doublings, std::round(doublings), 1e-9);
    const Eigen::Array2d cells = tile.corner.array() / tile.cell_m;
    EXPECT_LT((cells - cells.round()).abs().maxCoeff(), 1e-6);
    finest += tile.cell_m < 1.001 * kSmallCell_m;
  }
  EXPECT_LT(finest, std::ssize(Tiles().tiles()) / 2);
  SeededRandom random;
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector2d way(random.Uniform(0.0, 2.0), 0.0);
    const double angle = random.Uniform(0.0, 7.0), out_m = random.Uniform(0.0, 4.19);
    const Eigen::Vector2d position =
        way + out_m * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    EXPECT_LT(Tiles().tiles()[Tiles().TileAt(position)].cell_m, 1.001 * kSmallCell_m);
  }
}

TEST(SandTiles, ReachBeyondALongWay) {
  const std::vector<Eigen::Vector2d> outline{{0.0, 0.0}, {450.0, 0.0}, {900.0, 0.0}};
  const SandTiles tiles(outline, 0.1, 1.0);
  for (const Eigen::Vector2d& at : outline) {
    const SandTile& tile = tiles.tiles()[tiles.TileAt(at)];
    EXPECT_NEAR(tile.cell_m, 0.1, 1e-9);
    EXPECT_LE(tile.corner.x(), at.x());
    EXPECT_GE(tile.corner.x() + kCells * tile.cell_m, at.x());
  }
  const SandTile& far = tiles.tiles()[tiles.TileAt({1290.0, 0.0})];
  EXPECT_GE(far.corner.x() + kCells * far.cell_m, 1290.0);
}

TEST(SandTiles, MeshPassesThroughTheHeightsAndHasSkirts) {
  const std::vector<Eigen::Vector2d> outline{{0.0, 0.0}};
  const SandTiles tiles(outline, 0.1, 1.0);
  const Terrain terrain(TerrainOptions{});
  const SandMesh mesh = MeshTiles(tiles, SandHeights(terrain, tiles));
  ASSERT_EQ(mesh.grids.size(), tiles.tiles().size());
  SeededRandom random;
  for (int i = 0; i < 5000; ++i) {
    const auto index = static_cast<std::size_t>(random.Uniform(0.0, 1.0 * mesh.grids.size()));
    const SandTile& tile = tiles.tiles()[index];
    const VertexGrid& grid = mesh.grids[index];
    ASSERT_EQ(grid.columns, kCells + 3);
    ASSERT_EQ(grid.rows, kCells + 3);
    const int column = static_cast<int>(random.Uniform(0.0, kCells + 3.0)),
              row = static_cast<int>(random.Uniform(0.0, kCells + 3.0));
    const Eigen::Vector3f& node = mesh.vertices[grid.first + row * grid.columns + column];
    const double x = tile.corner.x() + tile.cell_m * std::clamp(column - 1, 0, kCells),
                 y = tile.corner.y() + tile.cell_m * std::clamp(row - 1, 0, kCells);
    const bool is_skirt = std::min(column, row) == 0 || std::max(column, row) == kCells + 2;
    EXPECT_EQ(node.x(), static_cast<float>(x));
    EXPECT_EQ(node.y(), static_cast<float>(y));
    const double height_m = terrain.Height(x, y, tile.cell_m);
    if (is_skirt) {
      EXPECT_LT(node.z(), height_m - 0.02);
    } else {
      EXPECT_NEAR(node.z(), height_m, 1e-5);
    }
  }
}

}  // namespace
}  // namespace rigmap
