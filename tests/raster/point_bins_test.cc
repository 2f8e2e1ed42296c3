#include "raster/internal/point_bins.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "core/error.h"
#include "tests/raster/synthetic_map.h"
#include "tests/support/message_of.h"
#include "tests/support/seeded_random.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

constexpr int kBinMargin = 7;
constexpr int kBinTile = CellFrame::kTileCells;
// Three tiles by two, those at the end cut.
constexpr CellFrame kBinFrame{
    .cell_m = 0.01, .west = -300, .north = 250, .columns = 1100, .rows = 600};

class PointBinsTest : public testing::Test {
 protected:
  // In the middle of a cell; told apart by the height.
  SurfacePoint PointAt(int column, int row) {
    return MapPoint((static_cast<double>(kBinFrame.west) + column + 0.5) * kBinFrame.cell_m,
                    (static_cast<double>(kBinFrame.north) - row + 0.5) * kBinFrame.cell_m,
                    static_cast<double>(next_++));
  }
  std::vector<BinnedPoint> Held(int tile_column, int tile_row) {
    std::vector<BinnedPoint> held;
    bins_.ForEach(tile_column, tile_row, [&](std::span<const BinnedPoint> points) {
      held.insert(held.end(), points.begin(), points.end());
    });
    return held;
  }

  TemporaryFolder folder_;
  PointBins bins_{PointCells(kBinFrame, {}), kBinMargin, folder_.Path() / "points"};
  int next_ = 0;
};

// Against asking every tile about every point.
TEST_F(PointBinsTest, EachTileHoldsItsPointsAndThoseOfItsMargin) {
  SeededRandom random;
  std::vector<std::pair<int, int>> cells;
  for (int i = 0; i < 3000; ++i) {
    cells.emplace_back(static_cast<int>(random.Uniform(0.0, kBinFrame.columns)),
                       static_cast<int>(random.Uniform(0.0, kBinFrame.rows)));
    bins_.Add(PointAt(cells.back().first, cells.back().second));
    if (i % 1000 == 0) bins_.Flush();
  }
  bins_.Flush();
  for (int tile_row = 0; tile_row < 2; ++tile_row) {
    for (int tile_column = 0; tile_column < 3; ++tile_column) {
      const auto held = Held(tile_column, tile_row);
      std::size_t next = 0;
      for (std::size_t i = 0; i < cells.size(); ++i) {
        const int column = cells[i].first - tile_column * kBinTile + kBinMargin,
                  row = cells[i].second - tile_row * kBinTile + kBinMargin;
        const int side = kBinTile + 2 * kBinMargin;
        if (column < 0 || column >= side || row < 0 || row >= side) continue;
        ASSERT_LT(next, held.size());
        EXPECT_EQ(held[next].sample.height_m, static_cast<float>(i)) << "in the order of Add";
        EXPECT_EQ(held[next].column, column);
        EXPECT_EQ(held[next].row, row);
        ++next;
      }
      EXPECT_EQ(next, held.size());
      EXPECT_EQ(bins_.HasPoints(tile_column, tile_row), !held.empty());
    }
  }
}

TEST_F(PointBinsTest, KeepsColourAndObservations) {
  SurfacePoint point = PointAt(3, 4);
  point.rgb = {1, 2, 3};
  point.observations = 65535;
  bins_.Add(point);
  bins_.Flush();
  ASSERT_EQ(Held(0, 0).size(), 1U);
  EXPECT_EQ(Held(0, 0)[0].sample.rgb, point.rgb);
  EXPECT_EQ(Held(0, 0)[0].sample.observations, 65535.0F);
  EXPECT_FALSE(bins_.HasPoints(1, 0));
  EXPECT_FALSE(bins_.HasPoints(0, 1));
}

TEST_F(PointBinsTest, CornersOfTheFrameAreInside) {
  bins_.Add(PointAt(0, 0));
  bins_.Add(PointAt(kBinFrame.columns - 1, kBinFrame.rows - 1));
  bins_.Flush();
  EXPECT_EQ(Held(0, 0).size(), 1U);
  EXPECT_EQ(Held(2, 1).size(), 1U);
}

TEST(PointBins, NamesTheFileItCannotWrite) {
  const TemporaryFolder folder;
  const auto path = folder.Path() / "none" / "points";
  EXPECT_THAT(MessageOf<DataError>([&] { PointBins(PointCells(kBinFrame, {}), kBinMargin, path); }),
              testing::HasSubstr(path.string()));
}

}  // namespace
}  // namespace rigmap
