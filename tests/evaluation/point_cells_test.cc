#include "evaluation/internal/point_cells.h"

#include <gtest/gtest.h>

#include "evaluation/internal/rock_sheets.h"

namespace rigmap {
namespace {

using Positions = std::vector<Eigen::Vector3d>;

const Positions kPositions{
    {0.011, 0.0, 0.0}, {-0.001, 0.0, 0.0}, {0.019, 0.009, 0.0}, {0.019, 0.009, -0.001}};

TEST(PointCells, AreCubesWithCornersAtMultiplesOfTheirSide) {
  const PointCells cells = SortIntoCells(kPositions, 0.01);
  EXPECT_EQ(cells.sizes.size(), 3U);
  EXPECT_EQ(cells.of_point[0], cells.of_point[2]);
  EXPECT_NE(cells.of_point[0], cells.of_point[1]);
  EXPECT_NE(cells.of_point[2], cells.of_point[3]);
  EXPECT_EQ(cells.sizes[cells.of_point[0]], 2U);
}

TEST(PointCells, AreColumnsWhateverTheHeight) {
  const PointCells cells = SortIntoColumns(kPositions, 0.01);
  EXPECT_EQ(cells.sizes.size(), 2U);
  EXPECT_EQ(cells.sizes[cells.of_point[3]], 3U);
}

TEST(PointCells, HaveTheMeanOfTheirValues) {
  const PointCells cells = SortIntoColumns(kPositions, 0.01);
  const std::vector<double> values{1.0, 7.0, 2.0, 6.0};
  const auto means = MeansOfCells(cells, values);
  EXPECT_EQ(means[cells.of_point[0]], 3.0);
  EXPECT_EQ(means[cells.of_point[1]], 7.0);
}

TEST(PointCells, AreNoneOfNoPoints) { EXPECT_TRUE(SortIntoCells({}, 0.01).sizes.empty()); }

// Four cubes: one sheet, two sheets, a stray over one, and too few points.
TEST(ShareInTwoSheets, CountsCubesWithAGapBetweenTwoSheets) {
  Positions x;
  std::vector<double> offset_m;
  const auto add = [&](double at_m, const std::vector<double>& offsets_m) {
    for (const double offset : offsets_m) {
      x.emplace_back(at_m, 0.0, 0.0);
      offset_m.push_back(offset);
    }
  };
  EXPECT_EQ(ShareInTwoSheets(x, offset_m), 0.0);
  add(0.01, {0.0, 0.009, 0.018, -0.009});
  add(0.04, {0.001, 0.03, 0.002, 0.028, 0.003});
  add(0.07, {0.0, 0.0, 0.001, 0.03, 0.0});
  add(0.10, {0.0, 0.03, 0.03});
  EXPECT_NEAR(ShareInTwoSheets(x, offset_m), 1.0 / 3.0, 1e-12);
}

// Two points over eleven are less than a fifth.
TEST(ShareInTwoSheets, AsksForAFifthOfTheCube) {
  Positions x(13, Eigen::Vector3d::Zero());
  std::vector<double> offset_m(13, 0.0);
  offset_m[4] = offset_m[8] = 0.02;
  EXPECT_EQ(ShareInTwoSheets(x, offset_m), 0.0);
  offset_m[1] = 0.02;
  EXPECT_EQ(ShareInTwoSheets(x, offset_m), 1.0);
}

}  // namespace
}  // namespace rigmap
