#include "raster/upper_surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

using Rgb = std::array<std::uint8_t, 3>;

struct Sample {
  int column;
  int row;
  float height_m;
  Rgb rgb;
  std::uint16_t observations;
};

SurfaceGrid Seen(int columns, int rows, double layer_m, const std::vector<Sample>& samples) {
  UpperSurface surface(columns, rows, layer_m);
  for (const Sample& s : samples) surface.Raise(s.column, s.row, s.height_m);
  for (const Sample& s : samples) surface.Blend(s.column, s.row, s.height_m, s.rgb, s.observations);
  return surface.Finish();
}

// A plane with colours that grow with the column; `holds` tells which cells were seen.
template <class Holds>
SurfaceGrid Plane(int columns, int rows, Holds holds) {
  std::vector<Sample> samples;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      if (!holds(column, row)) continue;
      const auto grey = static_cast<std::uint8_t>(10 * column);
      samples.push_back({column, row, 0.25F * column - 0.5F * row, {grey, grey, grey}, 1});
    }
  }
  return Seen(columns, rows, 0.01, samples);
}

TEST(UpperSurface, IsTheWeightedMeanOfTheTopLayer) {
  const SurfaceGrid grid = Seen(2, 1, 0.01,
                                {{0, 0, 1.000F, {100, 0, 0}, 3},
                                 {0, 0, 0.996F, {200, 0, 0}, 1},
                                 {0, 0, 0.980F, {0, 255, 255}, 100}});
  EXPECT_NEAR(grid.height_m[0], 0.999, 1e-6);  // m
  EXPECT_EQ(grid.rgb[0], (Rgb{125, 0, 0}));
  EXPECT_TRUE(std::isnan(grid.height_m[1]));
  EXPECT_FALSE(grid.Holds(1, 0));
  EXPECT_FALSE(grid.Holds(-1, 0));
  EXPECT_FALSE(grid.Holds(0, 1));
}

TEST(UpperSurface, DoesNotDependOnTheOrderOfThePoints) {
  SeededRandom random;
  std::vector<Sample> samples;
  for (int i = 0; i < 500; ++i) {
    const auto column = static_cast<int>(random.Uniform(0.0, 4.0));
    const auto grey = static_cast<std::uint8_t>(random.Uniform(0.0, 256.0));
    samples.push_back({column,
                       0,
                       static_cast<float>(random.Uniform(0.0, 0.02)),
                       {grey, grey, grey},
                       static_cast<std::uint16_t>(random.Uniform(1.0, 50.0))});
  }
  const SurfaceGrid forwards = Seen(4, 1, 0.01, samples);
  std::reverse(samples.begin(), samples.end());
  const SurfaceGrid backwards = Seen(4, 1, 0.01, samples);
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(forwards.height_m[i], backwards.height_m[i], 1e-6);  // m
    EXPECT_NEAR(forwards.rgb[i][0], backwards.rgb[i][0], 1);
  }
}

TEST(FillPinholes, FollowsAPlane) {
  const auto hole = [](int column, int row) {
    return column >= 4 && column <= 6 && row >= 3 && row <= 5;
  };
  SurfaceGrid grid = Plane(12, 10, [&](int c, int r) { return !hole(c, r); });
  EXPECT_EQ(FillPinholes(grid, 2, 2), 0U);
  EXPECT_EQ(FillPinholes(grid, 3, 3), 9U);
  const SurfaceGrid truth = Plane(12, 10, [](int, int) { return true; });
  for (std::size_t i = 0; i < grid.height_m.size(); ++i) {
    EXPECT_NEAR(grid.height_m[i], truth.height_m[i], 1e-5);  // m
    EXPECT_NEAR(grid.rgb[i][0], truth.rgb[i][0], 1);
  }
}

TEST(FillPinholes, ClosesNarrowSlitsUpToALength) {
  SurfaceGrid grid =
      Plane(14, 8, [](int c, int r) { return c < 3 || c >= 9 || (r != 3 && r != 4); });
  EXPECT_EQ(FillPinholes(grid, 1, 6), 0U);
  EXPECT_EQ(FillPinholes(grid, 2, 5), 0U);
  EXPECT_EQ(FillPinholes(grid, 2, 6), 12U);
}

TEST(FillPinholes, NeverGrowsOverAnOuterEdge) {
  // A disc, a half plane and a wedge.
  const auto disc = [](int c, int r) { return std::hypot(c - 15.0, r - 15.0) < 10.0; };
  const auto half = [](int c, int r) { return c + 2 * r < 40; };
  const auto wedge = [](int c, int r) { return c > 10 && r > 5 && r < c; };
  for (const auto& holds : std::vector<std::function<bool(int, int)>>{disc, half, wedge}) {
    SurfaceGrid grid = Plane(30, 30, holds);
    EXPECT_EQ(FillPinholes(grid, 4, 8), 0U);
  }
}

TEST(FillPinholes, LeavesWideHolesAndNothingToFillAlone) {
  const auto inside = [](int c, int r) { return c > 5 && c < 15 && r > 5 && r < 15; };
  SurfaceGrid grid = Plane(20, 20, [&](int c, int r) { return !inside(c, r); });
  EXPECT_EQ(FillPinholes(grid, 4, 8), 0U);
  SurfaceGrid nothing = Plane(20, 20, [](int, int) { return false; });
  EXPECT_EQ(FillPinholes(nothing, 4, 8), 0U);
}

}  // namespace
}  // namespace rigmap
