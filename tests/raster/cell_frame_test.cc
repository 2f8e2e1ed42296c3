#include "raster/cell_frame.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "core/error.h"
#include "tests/raster/synthetic_map.h"
#include "tests/support/message_of.h"
#include "tests/support/seeded_random.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

constexpr double kCell_m = 0.05;

CellFrame FrameOfCloud(const PointCloud& cloud) {
  const TemporaryFolder folder;
  return FrameOf({WriteCloud(folder.Path() / "cloud.ply", cloud), kCell_m});
}

TEST(CellFrame, HoldsEveryPointAndNoCellMore) {
  SeededRandom random;
  PointCloud cloud;
  for (int i = 0; i < 200; ++i) {
    cloud.push_back(MapPoint(random.Uniform(-7.0, 3.0), random.Uniform(-40.0, 2.0), 0.0));
  }
  const CellFrame frame = FrameOfCloud(cloud);
  int west = frame.columns, east = -1, top = frame.rows, bottom = -1;
  for (const SurfacePoint& point : cloud) {
    const int column = frame.Column(point.x_in_world.x()), row = frame.Row(point.x_in_world.y());
    west = std::min(west, column);
    east = std::max(east, column);
    top = std::min(top, row);
    bottom = std::max(bottom, row);
  }
  EXPECT_EQ(west, 0);
  EXPECT_EQ(top, 0);
  EXPECT_EQ(east, frame.columns - 1);
  EXPECT_EQ(bottom, frame.rows - 1);
}

// Eight voxels of 0.1 m are a float that is more than eight doubles of 0.1 m.
TEST(CellFrame, ShowsGrainsOfEightVoxelsOfAnySize) {
  for (const double voxel_m : {0.001, 0.003, 0.01, 0.03, 0.1, 0.3}) {
    SurfacePoint fine = MapPoint(0.0, 0.0, 0.0), coarse = MapPoint(1.0, 0.0, 0.0),
                 too_coarse = MapPoint(2.0, 0.0, 0.0);
    fine.grain_m = static_cast<float>(0.5 * voxel_m);
    coarse.grain_m = static_cast<float>(8.0 * voxel_m);
    too_coarse.grain_m = static_cast<float>(16.0 * voxel_m);
    const TemporaryFolder folder;
    const GriddedCloud cloud{WriteCloud(folder.Path() / "cloud.ply", {fine, coarse, too_coarse}),
                             voxel_m};
    std::vector<float> shown;
    ForEachShown(cloud, [&](const SurfacePoint& point) { shown.push_back(point.x_in_world.x()); });
    EXPECT_THAT(shown, testing::ElementsAre(0.0F, 1.0F)) << voxel_m;
    SurfacePoint plain = fine;
    plain.grain_m = static_cast<float>(voxel_m);
    EXPECT_FALSE(plain.IsCoarserThan(voxel_m));
    EXPECT_TRUE(coarse.IsCoarserThan(voxel_m));
  }
}

TEST(CellFrame, NumbersCellsFromTheUpperLeft) {
  const CellFrame frame = FrameOfCloud({MapPoint(1.01, 2.01, 0.0), MapPoint(3.01, 5.01, 0.0)});
  const Eigen::Vector2d corner = frame.UpperLeft();
  EXPECT_LT((corner - Eigen::Vector2d(1.0, 5.05)).norm(), 1e-9);
  for (const int cell : {0, 1, 17}) {
    EXPECT_EQ(frame.Column(corner.x() + (cell + 0.5) * kCell_m), cell);
    EXPECT_EQ(frame.Row(corner.y() - (cell + 0.5) * kCell_m), cell);
  }
}

TEST(CellFrame, TilesCoverAllCells) {
  CellFrame frame{.cell_m = 1.0, .columns = 512, .rows = 513};
  EXPECT_EQ(frame.TilesAcross(), 1);
  EXPECT_EQ(frame.TilesDown(), 2);
}

TEST(CellFrame, PassesOverPointsThatAreNowhere) {
  const double nowhere = std::numeric_limits<double>::quiet_NaN();
  const CellFrame frame = FrameOfCloud({MapPoint(0.01, 0.01, 0.0), MapPoint(nowhere, 0.0, 0.0)});
  EXPECT_EQ(frame.columns, 1);
  EXPECT_EQ(frame.rows, 1);
}

TEST(CellFrame, RefusesCloudsWithoutAPoint) {
  EXPECT_THAT(MessageOf<DataError>([] { FrameOfCloud({}); }), testing::HasSubstr("cloud.ply"));
}

TEST(CellFrame, TakesCoarserCellsForCloudsThatAreVeryWide) {
  const CellFrame frame = FrameOfCloud({MapPoint(-1e4, -1e4, 0.0), MapPoint(1e4, 1e4, 0.0)});
  EXPECT_EQ(frame.cell_m, 16.0 * kCell_m);  // 6.25e8 of them
  EXPECT_LT(frame.UpperLeft().x(), -1e4 + frame.cell_m);
  EXPECT_NEAR(frame.columns * frame.cell_m, 2e4, 2.0 * frame.cell_m);
}

}  // namespace
}  // namespace rigmap
