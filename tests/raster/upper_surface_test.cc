#include "raster/upper_surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

using Rgb = std::array<std::uint8_t, 3>;

struct Sample {
  int column;
  int row;
  CellSample cell;
};

Sample At(int column, float height_m, const Rgb& rgb, float weight) {
  return {column, 0, {.height_m = height_m, .rgb = rgb, .weight = weight}};
}

SurfaceGrid Seen(int columns, int rows, double layer_m, const std::vector<Sample>& samples) {
  UpperSurface surface(columns, rows, layer_m);
  for (const Sample& s : samples) surface.Raise(s.column, s.row, s.cell);
  for (const Sample& s : samples) surface.Blend(s.column, s.row, s.cell);
  return surface.Finish();
}

TEST(UpperSurface, IsTheWeightedMeanOfTheTopLayer) {
  const SurfaceGrid grid = Seen(2, 1, 0.01,
                                {At(0, 1.000F, {100, 0, 0}, 3.0F), At(0, 0.996F, {200, 0, 0}, 1.0F),
                                 At(0, 0.980F, {0, 255, 255}, 100.0F)});
  EXPECT_NEAR(grid.height_m[0], 0.999, 1e-6);  // m
  EXPECT_EQ(grid.rgb[0], (Rgb{125, 0, 0}));
  EXPECT_TRUE(std::isnan(grid.height_m[1]));
  EXPECT_FALSE(grid.Holds(1, 0));
  EXPECT_FALSE(grid.Holds(-1, 0));
  EXPECT_FALSE(grid.Holds(0, 1));
}

// Of two that may be the same the one that is known better is seen, and hides it.
TEST(UpperSurface, WhatIsDoubtfulHidesOnlyWhatIsFarBelow) {
  const auto seen = [](float doubtful_height_m) {
    Sample doubtful = At(0, doubtful_height_m, {200, 0, 0}, 10.0F);
    doubtful.cell.doubt_m = 0.2F;
    return Seen(1, 1, 0.01, {doubtful, At(0, 1.0F, {100, 0, 0}, 1.0F)}).height_m[0];
  };
  EXPECT_FLOAT_EQ(seen(1.15F), 1.0F);
  EXPECT_FLOAT_EQ(seen(1.25F), 1.25F);
  EXPECT_FLOAT_EQ(seen(0.9F), 1.0F);
}

TEST(UpperSurface, DoesNotDependOnTheOrderOfThePoints) {
  SeededRandom random;
  std::vector<Sample> samples;
  for (int i = 0; i < 500; ++i) {
    const auto column = static_cast<int>(random.Uniform(0.0, 4.0));
    const auto grey = static_cast<std::uint8_t>(random.Uniform(0.0, 256.0));
    samples.push_back(At(column, static_cast<float>(random.Uniform(0.0, 0.02)), {grey, grey, grey},
                         static_cast<float>(random.Uniform(1.0, 50.0))));
  }
  const SurfaceGrid forwards = Seen(4, 1, 0.01, samples);
  std::reverse(samples.begin(), samples.end());
  const SurfaceGrid backwards = Seen(4, 1, 0.01, samples);
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(forwards.height_m[i], backwards.height_m[i], 1e-6);  // m
    EXPECT_NEAR(forwards.rgb[i][0], backwards.rgb[i][0], 1);
  }
}

}  // namespace
}  // namespace rigmap
