#include "raster/fill_pinholes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

namespace rigmap {
namespace {

// A plane with colours that grow with the column; `holds` tells which cells were seen.
template <class Holds>
SurfaceGrid Plane(int columns, int rows, Holds holds) {
  SurfaceGrid grid{columns, rows};
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const bool seen = holds(column, row);
      const auto grey = static_cast<std::uint8_t>(seen ? 10 * column : 0);
      grid.height_m.push_back(seen ? 0.25F * column - 0.5F * row : NAN);
      grid.rgb.push_back({grey, grey, grey});
    }
  }
  return grid;
}

TEST(FillPinholes, FollowsAPlane) {
  const auto hole = [](int column, int row) {
    return column >= 4 && column <= 6 && row >= 3 && row <= 5;
  };
  SurfaceGrid grid = Plane(12, 10, [&](int c, int r) { return !hole(c, r); });
  EXPECT_EQ(FillPinholes(grid, 2), 0U);
  EXPECT_EQ(FillPinholes(grid, 3), 9U);
  const SurfaceGrid truth = Plane(12, 10, [](int, int) { return true; });
  for (std::size_t i = 0; i < grid.height_m.size(); ++i) {
    EXPECT_NEAR(grid.height_m[i], truth.height_m[i], 1e-5);  // m
    EXPECT_NEAR(grid.rgb[i][0], truth.rgb[i][0], 1);
  }
}

TEST(FillPinholes, ClosesNarrowSlitsHoweverLong) {
  SurfaceGrid grid =
      Plane(26, 8, [](int c, int r) { return c < 3 || c >= 21 || (r != 3 && r != 4); });
  EXPECT_EQ(FillPinholes(grid, 1), 0U);
  EXPECT_EQ(FillPinholes(grid, 2), 36U);
  // Two slits that cross askew, through the middle of a field.
  const auto slit = [](int c, int r) {
    return std::abs(c - r) <= 1 || std::abs(c + 2 * r - 60) <= 2;
  };
  SurfaceGrid crossed =
      Plane(40, 40, [&](int c, int r) { return r < 5 || r >= 35 || !slit(c, r); });
  FillPinholes(crossed, 5);
  for (int row = 8; row < 32; ++row) {
    for (int column = 8; column < 32; ++column) {
      ASSERT_TRUE(crossed.Holds(column, row)) << column << " " << row;
      ASSERT_NEAR(crossed.height_m[crossed.Index(column, row)], 0.25F * column - 0.5F * row, 1e-4);
    }
  }
}

TEST(FillPinholes, NeverGrowsOverAnOuterEdge) {
  // A disc, half planes and a wedge.
  const auto disc = [](int c, int r) { return std::hypot(c - 15.0, r - 15.0) < 10.0; };
  const auto half = [](int c, int r) { return c + 2 * r < 40; };
  const auto wedge = [](int c, int r) { return c > 10 && r > 5 && r < c; };
  for (const auto& holds : std::vector<std::function<bool(int, int)>>{disc, half, wedge}) {
    for (const int width : {1, 2, 3, 4, 8, 13}) {
      SurfaceGrid grid = Plane(30, 30, holds);
      EXPECT_EQ(FillPinholes(grid, width), 0U) << width;
    }
  }
  for (int degrees = 0; degrees < 360; degrees += 7) {
    const double angle = degrees * std::numbers::pi / 180.0;
    for (const int width : {1, 2, 3, 4, 8, 13}) {
      SurfaceGrid grid = Plane(40, 40, [&](int c, int r) {
        return (c - 20) * std::cos(angle) + (r - 20) * std::sin(angle) < 0.3;
      });
      EXPECT_EQ(FillPinholes(grid, width), 0U) << degrees << " " << width;
    }
  }
}

TEST(FillPinholes, LeavesWideHolesAndNothingToFillAlone) {
  const auto inside = [](int c, int r) { return c > 5 && c < 15 && r > 5 && r < 15; };
  SurfaceGrid grid = Plane(20, 20, [&](int c, int r) { return !inside(c, r); });
  EXPECT_EQ(FillPinholes(grid, 4), 0U);
  SurfaceGrid nothing = Plane(20, 20, [](int, int) { return false; });
  EXPECT_EQ(FillPinholes(nothing, 4), 0U);
}

// Each cell as in the whole, so that maps can be filled tile by tile.
TEST(FillPinholes, ReachesNoFurtherThanItSays) {
  constexpr int kWidth = 4, kSide = 60, kCut = 30;
  const auto holds = [](int c, int r) { return (7 * c + 11 * r + c * r) % 13 < 4; };
  SurfaceGrid whole = Plane(kSide, kSide, holds);
  FillPinholes(whole, kWidth);
  const int reach = FillReach(kWidth);
  SurfaceGrid tile = Plane(kCut + reach, kSide, holds);
  FillPinholes(tile, kWidth);
  for (int row = 0; row < kSide; ++row) {
    for (int column = 0; column < kCut; ++column) {
      ASSERT_EQ(tile.Holds(column, row), whole.Holds(column, row));
      if (!tile.Holds(column, row)) continue;
      ASSERT_EQ(tile.height_m[tile.Index(column, row)], whole.height_m[whole.Index(column, row)]);
    }
  }
}

}  // namespace
}  // namespace rigmap
