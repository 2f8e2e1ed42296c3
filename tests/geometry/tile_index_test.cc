#include "geometry/tile_index.h"

#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

TEST(TileIndex, HoldsWhatLiesBetweenItsEdges) {
  SeededRandom random;
  for (int i = 0; i < 1000; ++i) {
    const double size = random.Uniform(0.01, 10.0);
    const Eigen::Vector2d position(random.Uniform(-100.0, 100.0), random.Uniform(-100.0, 100.0));
    const auto [x, y] = TileAt(position, size);
    EXPECT_LE(static_cast<double>(x) * size, position.x() + 1e-9);
    EXPECT_GT(static_cast<double>(x + 1) * size, position.x() - 1e-9);
    EXPECT_LE(static_cast<double>(y) * size, position.y() + 1e-9);
    EXPECT_GT(static_cast<double>(y + 1) * size, position.y() - 1e-9);
  }
}

TEST(TileIndex, HoldsItsLowerEdges) {
  EXPECT_EQ(TileAt({0.0, -0.5}, 0.5), TileIndex(0, -1));
  EXPECT_EQ(TileAt({-0.1, 0.49}, 0.5), TileIndex(-1, 0));
}

TEST(TileIndex, TakesWhatIsTooFarToTheOutermost) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  constexpr std::int64_t kOutermost = 1'000'000'000'000'000;
  EXPECT_EQ(TileAlong(kInfinity, 0.1), kOutermost);
  EXPECT_EQ(TileAlong(-kInfinity, 0.1), -kOutermost);
  EXPECT_EQ(std::abs(TileAlong(std::numeric_limits<double>::quiet_NaN(), 0.1)), kOutermost);
  EXPECT_EQ(TileAlong(5e14, 1.0), 500'000'000'000'000);
}

// Cells of 2 cm in tiles of 16: the same tile as of the place itself.
TEST(TileOfCell, IsTheTileOfThePosition) {
  for (std::int64_t cell = -100; cell < 100; ++cell) {
    EXPECT_EQ(TileOfCell(cell, 16), TileAlong(static_cast<double>(cell) + 0.5, 16.0)) << cell;
  }
}

TEST(TileHash, TellsNeighboursApart) {
  std::set<std::size_t> hashes;
  for (std::int64_t x = -50; x < 50; ++x) {
    for (std::int64_t y = -50; y < 50; ++y) hashes.insert(TileHash()({x, y}));
  }
  EXPECT_EQ(hashes.size(), 10000U);
}

}  // namespace
}  // namespace rigmap
