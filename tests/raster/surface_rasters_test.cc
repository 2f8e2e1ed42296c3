#include "raster/surface_rasters.h"

#include <gdal_priv.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <random>
#include <set>

#include "core/error.h"
#include "tests/raster/synthetic_map.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_file.h"

namespace rigmap {
namespace {

using testing::Each;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

constexpr double kCell = 0.02;  // m: 200 x 100 cells

std::unique_ptr<GDALDataset> Open(const std::filesystem::path& path) {
  GDALAllRegister();
  std::unique_ptr<GDALDataset> dataset(GDALDataset::Open(path.string().c_str(), GDAL_OF_RASTER));
  if (!dataset) throw std::runtime_error("cannot open " + path.string());
  return dataset;
}

std::vector<float> Band(GDALDataset& dataset, int band) {
  const int columns = dataset.GetRasterXSize(), rows = dataset.GetRasterYSize();
  std::vector<float> values(static_cast<std::size_t>(columns) * rows);
  EXPECT_EQ(dataset.GetRasterBand(band)->RasterIO(GF_Read, 0, 0, columns, rows, values.data(),
                                                  columns, rows, GDT_Float32, 0, 0),
            CE_None);
  return values;
}

class Rasters : public testing::Test {
 protected:
  void Write(const PointCloud& cloud, const RasterInputs& inputs = {}) {
    const auto ply = WriteCloud(folder_.Path() / "dense.ply", cloud);
    WriteSurfaceRasters({ply, cell_m_}, folder_.Path(), options_, terrain_, inputs);
  }
  std::unique_ptr<GDALDataset> Height() { return Open(folder_.Path() / "height.tif"); }
  std::unique_ptr<GDALDataset> Terrain() { return Open(folder_.Path() / "terrain.tif"); }
  std::unique_ptr<GDALDataset> Ortho() { return Open(folder_.Path() / "ortho.tif"); }
  // Of the cell in which the point lies.
  std::size_t Index(double x_m, double y_m) const {
    return static_cast<std::size_t>((1.5 - y_m) / kCell) * 200 +
           static_cast<std::size_t>((x_m + 1.0) / kCell);
  }

  TemporaryFolder folder_;
  double cell_m_ = kCell;
  RasterOptions options_;
  FootprintOptions terrain_{.footprint_m = 0.4};
};

TEST_F(Rasters, HoldTheHeightsNorthUp) {
  Write(MapCloud(kCell));
  const auto height = Height();
  ASSERT_EQ(height->GetRasterXSize(), 200);
  ASSERT_EQ(height->GetRasterYSize(), 100);
  const auto values = Band(*height, 1);
  for (int row = 0; row < 100; ++row) {
    for (int column = 0; column < 200; ++column) {
      const double x_m = -1.0 + (column + 0.5) * kCell, y_m = 1.5 - (row + 0.5) * kCell;
      const bool box = x_m > 2.0 && x_m < 2.4 && y_m > 1.0 && y_m < 1.2;
      ASSERT_NEAR(values[row * 200 + column], GroundHeight(x_m, y_m) + (box ? 0.4 : 0.0), 1e-6)
          << column << " " << row;
    }
  }
}

// A rover that stood there long with its back to the ground.
TEST_F(Rasters, KnowTheViewThatSawTheGroundAmongAnyNumberThatDidNot) {
  const Camera camera{.width = 400, .height = 400, .fx = 200, .fy = 200, .cx = 200, .cy = 200};
  Eigen::Matrix3d down, up;  // x to the east
  down << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  up << 1, 0, 0, 0, 1, 0, 0, 0, 1;
  const Eigen::Vector3d above(1.0, 0.5, 4.0);
  Trajectory trajectory(900, {.world_from_left = {Eigen::Quaterniond(up), {1.0, 0.5, 0.0}}});
  trajectory.push_back({.world_from_left = {Eigen::Quaterniond(down), above}});
  Write(MapCloud(kCell), {.trajectory = &trajectory, .left_camera = &camera});
  const auto height = Height();
  ASSERT_STREQ(height->GetRasterBand(4)->GetDescription(), "view_angle");
  const auto angles = Band(*height, 4);
  for (const double x_m : {-0.5, 0.5, 1.5}) {
    const Eigen::Vector3d ray = above - Eigen::Vector3d(x_m, 0.5, GroundHeight(x_m, 0.5));
    // Points without normals count as level.
    const double expected_deg = std::acos(ray.normalized().z()) * 180.0 / M_PI;
    EXPECT_NEAR(angles[Index(x_m, 0.5)], expected_deg, 0.5);
  }
}

TEST_F(Rasters, SayWhereTheyLieAndWhatTheyHold) {
  Write(MapCloud(kCell));
  for (const auto& dataset : {Height().release(), Ortho().release()}) {
    const std::unique_ptr<GDALDataset> owner(dataset);
    std::array<double, 6> transform{};
    ASSERT_EQ(owner->GetGeoTransform(transform.data()), CE_None);
    const std::array<double, 6> expected{-1.0, kCell, 0.0, 1.5, 0.0, -kCell};
    for (int i = 0; i < 6; ++i) EXPECT_NEAR(transform[i], expected[i], 1e-12) << i;
    ASSERT_NE(owner->GetSpatialRef(), nullptr);
    EXPECT_TRUE(owner->GetSpatialRef()->IsLocal());
    EXPECT_STREQ(owner->GetSpatialRef()->GetName(), "rigmap world");
    EXPECT_EQ(owner->GetSpatialRef()->GetLinearUnits(), 1.0);
    EXPECT_STREQ(owner->GetMetadataItem("AREA_OR_POINT"), "Area");
    EXPECT_STREQ(owner->GetMetadataItem("LAYOUT", "IMAGE_STRUCTURE"), "COG");
  }
  const auto height = Height();
  EXPECT_EQ(height->GetRasterCount(), 4);
  EXPECT_EQ(height->GetRasterBand(1)->GetRasterDataType(), GDT_Float32);
  EXPECT_EQ(height->GetRasterBand(1)->GetNoDataValue(), -9999.0);
  EXPECT_STREQ(height->GetRasterBand(1)->GetDescription(), "height");
  EXPECT_STREQ(height->GetRasterBand(1)->GetUnitType(), "metre");
  const auto ortho = Ortho();
  ASSERT_EQ(ortho->GetRasterCount(), 4);
  EXPECT_EQ(ortho->GetRasterBand(1)->GetColorInterpretation(), GCI_RedBand);
  EXPECT_EQ(ortho->GetRasterBand(4)->GetColorInterpretation(), GCI_AlphaBand);
  EXPECT_EQ(ortho->GetRasterBand(4)->GetRasterDataType(), GDT_Byte);
}

TEST_F(Rasters, HoldTheColoursSeenFromAbove) {
  PointCloud cloud = MapCloud(kCell);
  cloud.push_back(MapPoint(2.2, 1.1, -1.0, {0, 255, 0}));  // under the box
  Write(cloud);
  const auto ortho = Ortho();
  for (int band = 1; band <= 3; ++band) {
    const auto values = Band(*ortho, band);
    EXPECT_EQ(values[Index(2.201, 1.101)], kBoxRgb[band - 1]);
    EXPECT_EQ(values[Index(2.201, -0.199)], kSandRgb[band - 1]);
    EXPECT_EQ(values[Index(-0.499, 1.101)], kSandRgb[band - 1]);
  }
  EXPECT_THAT(Band(*ortho, 4), Each(255.0F));
}

TEST_F(Rasters, FillPinholesButNeitherBordersNorWideHoles) {
  const auto near = [](double x_m, double y_m, double cx_m, double cy_m, double reach_m) {
    return std::abs(x_m - cx_m) < reach_m && std::abs(y_m - cy_m) < reach_m;
  };
  std::ptrdiff_t left_out = 0;
  Write(MapCloud(kCell, [&](double x_m, double y_m) {
    const bool out = near(x_m, y_m, 0.01, 0.01, 0.03) ||  // three cells wide
                     near(x_m, y_m, 1.01, 0.01, 0.2) ||   // 0.4 m wide
                     x_m + y_m < -0.9;                    // a corner
    left_out += out ? 1 : 0;
    return out;
  }));
  const auto values = Band(*Height(), 1);
  EXPECT_EQ(std::ranges::count(values, -9999.0F), left_out - 9);
  EXPECT_NEAR(values[Index(0.01, 0.01)], GroundHeight(0.01, 0.01), 1e-6);  // m
  EXPECT_EQ(values[Index(1.01, 0.01)], -9999.0F);
  EXPECT_EQ(values[Index(-0.99, -0.49)], -9999.0F);
  const auto alpha = Band(*Ortho(), 4);
  for (std::size_t i = 0; i < values.size(); ++i) {
    ASSERT_EQ(alpha[i], values[i] == -9999.0F ? 0.0F : 255.0F);
  }
}

TEST_F(Rasters, FillPinholesOnTheBordersOfTiles) {
  cell_m_ = 0.004;  // 1000 x 500 cells: columns 511 and 512 lie in different tiles
  const auto x_of_column = [&](int column) { return -1.0 + (column + 0.5) * cell_m_; };
  Write(MapCloud(cell_m_, [&](double x_m, double y_m) {
    const bool row = std::abs(y_m - 0.502) < 0.001;
    return row &&
           (std::abs(x_m - x_of_column(511)) < 0.001 || std::abs(x_m - x_of_column(512)) < 0.001);
  }));
  const auto height = Height();
  EXPECT_EQ(height->GetRasterBand(1)->GetOverviewCount(), 1);
  int block_columns = 0, block_rows = 0;
  height->GetRasterBand(1)->GetBlockSize(&block_columns, &block_rows);
  EXPECT_EQ(block_columns, 512);
  const auto values = Band(*height, 1);
  EXPECT_EQ(std::ranges::count(values, -9999.0F), 0);
  const std::size_t row = 249;  // from y = 1.5 down to 0.5 + 0.004
  for (const int column : {511, 512}) {
    EXPECT_NEAR(values[row * 1000 + column], GroundHeight(x_of_column(column), 0.502), 1e-5);
  }
}

TEST_F(Rasters, HaveEqualBytesWheneverTheyAreWritten) {
  const PointCloud cloud = MapCloud(kCell);
  Write(cloud);
  const std::string height = ReadTextFile(folder_.Path() / "height.tif");
  const std::string ortho = ReadTextFile(folder_.Path() / "ortho.tif");
  const std::string terrain = ReadTextFile(folder_.Path() / "terrain.tif");
  Write(cloud);
  EXPECT_TRUE(ReadTextFile(folder_.Path() / "height.tif") == height);
  EXPECT_TRUE(ReadTextFile(folder_.Path() / "ortho.tif") == ortho);
  EXPECT_THAT(NamesIn(folder_.Path()),
              UnorderedElementsAre("dense.ply", "height.tif", "ortho.tif", "terrain.tif"));
  // In another folder and from a cloud in another order.
  PointCloud shuffled = cloud;
  std::shuffle(shuffled.begin(), shuffled.end(), std::mt19937(7));
  const TemporaryFolder other;
  WriteSurfaceRasters({WriteCloud(other.Path() / "elsewhere.ply", shuffled), kCell}, other.Path(),
                      options_, terrain_);
  EXPECT_TRUE(ReadTextFile(other.Path() / "terrain.tif") == terrain);
  EXPECT_TRUE(ReadTextFile(other.Path() / "height.tif") == height);
  EXPECT_TRUE(ReadTextFile(other.Path() / "ortho.tif") == ortho);
  EXPECT_THAT(height, testing::Not(HasSubstr(folder_.Path().filename().string())));
}

GridFrame KatwijkGrid() {
  EarthFrame frame{{52.21, 4.40, 6.0}, 1.3, {2.0, 3.0, -1.0}, {31, true}};
  return EarthMap(frame).GridAround(Eigen::Vector2d::Zero());
}

TEST_F(Rasters, OnAGridAreNorthUpWithEachPointAtItsPosition) {
  RasterInputs inputs;
  inputs.grid = KatwijkGrid();
  Write(MapCloud(kCell), inputs);
  const auto height = Height();
  ASSERT_NE(height->GetSpatialRef(), nullptr);
  EXPECT_STREQ(height->GetSpatialRef()->GetAuthorityCode(nullptr), "32631");
  std::array<double, 6> t{};
  ASSERT_EQ(height->GetGeoTransform(t.data()), CE_None);
  EXPECT_EQ(t[2], 0.0);
  EXPECT_EQ(t[4], 0.0);
  const auto values = Band(*height, 1), counts = Band(*height, 3);
  int seen = 0;
  for (const SurfacePoint& point : MapCloud(kCell)) {
    const Eigen::Vector3d grid = inputs.grid->GridFromWorld(point.x_in_world.cast<double>());
    const auto column = static_cast<int>((grid.x() - t[0]) / kCell);
    const auto row = static_cast<int>((t[3] - grid.y()) / kCell);
    const std::size_t cell = static_cast<std::size_t>(row) * height->GetRasterXSize() + column;
    if (point.rgb != kSandRgb || values[cell] == -9999.0F || counts[cell] == 0.0F) continue;
    const double box_m = std::abs(values[cell] - grid.z());
    ++seen;
    // A cell takes the point of the world's nearest cell, at most a cell aside on a slope of 0.11.
    if (box_m < 0.2) {
      EXPECT_NEAR(values[cell], grid.z(), 0.004);  // m
    }
  }
  EXPECT_GT(seen, 17000);
  // The ground has no hole that the world's map has not: as many cells as points, but for the rim.
  EXPECT_NEAR(std::ranges::count_if(values, [](float z) { return z != -9999.0F; }), 20000, 250);
}

// The gradient of the ground is (0.1, 0.05): 6.4 degrees, whatever the map is turned by.
TEST_F(Rasters, TerrainKnowsTheSlopeOfTheGround) {
  for (const bool on_earth : {false, true}) {
    RasterInputs inputs;
    if (on_earth) inputs.grid = KatwijkGrid();
    inputs.up = "imu";
    PointCloud cloud = MapCloud(kCell);
    for (SurfacePoint& point : cloud) {
      point.sigma_m = 0.004F;
      point.x_in_world.z() -= point.rgb == kBoxRgb ? 0.4F : 0.0F;  // without the box
    }
    Write(cloud, inputs);
    const auto terrain = Terrain();
    EXPECT_STREQ(terrain->GetMetadataItem("RIGMAP_FOOTPRINT_M"), "0.4");
    EXPECT_STREQ(terrain->GetMetadataItem("RIGMAP_MAX_SLOPE_DEG"), "15");
    EXPECT_STREQ(terrain->GetMetadataItem("RIGMAP_UP"), "imu");
    EXPECT_STREQ(terrain->GetMetadataItem("LAYOUT", "IMAGE_STRUCTURE"), "COG");
    const auto slopes = Band(*terrain, 1), roughness = Band(*terrain, 2);
    const auto steps = Band(*terrain, 3), steeper = Band(*terrain, 4);
    std::vector<float> of_ground;
    for (std::size_t i = 0; i < slopes.size(); ++i) {
      if (slopes[i] == -9999.0F) continue;
      of_ground.push_back(slopes[i]);
      EXPECT_LT(roughness[i], 0.005F);
      EXPECT_LT(steps[i], 0.02F);
      EXPECT_LT(steeper[i], 1e-4F);
    }
    EXPECT_GT(of_ground.size(), 1000U);
    for (const float slope_deg : of_ground) EXPECT_NEAR(slope_deg, 6.379, 0.5);
  }
}

TEST_F(Rasters, TerrainKnowsTheHeightOfABox) {
  Write(MapCloud(kCell));
  const auto steps = Band(*Terrain(), 3);
  EXPECT_NEAR(*std::ranges::max_element(steps), 0.4, 0.02);  // m
}

// Wherever a wall stands beside the borders of the tiles that are worked on one by one.
TEST_F(Rasters, TerrainKnowsAWallFromAsFarEverywhere) {
  constexpr double kBlock_m = 2 * kCell;
  std::set<long> columns_before;
  for (int blocks = 20; blocks < 80; ++blocks) {
    const double wall_m = -1.0 + blocks * kBlock_m;
    PointCloud cloud = MapCloud(kCell);
    for (SurfacePoint& point : cloud) {
      point.x_in_world.z() = point.x_in_world.x() > wall_m ? 0.3F : 0.0F;
    }
    Write(cloud);
    const auto terrain = Terrain();
    const auto steps = Band(*terrain, 3);
    const int columns = terrain->GetRasterXSize();
    const auto row = steps.begin() + columns * (terrain->GetRasterYSize() / 2);
    columns_before.insert(
        std::count_if(row, row + blocks, [](float step_m) { return step_m > 0.2F; }));
  }
  EXPECT_EQ(columns_before, std::set<long>{7});  // five of the radius, two that a step is wide
}

TEST_F(Rasters, HoldSigmaCountAndViewAngle) {
  PointCloud cloud = MapCloud(kCell);
  for (SurfacePoint& point : cloud) {
    point.sigma_m = 0.003F;
    point.normal = Eigen::Vector3f(-0.1F, -0.05F, 1.0F).normalized();
  }
  Trajectory trajectory(1);
  Eigen::Matrix3d world_from_left;  // straight down, right along x
  world_from_left << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  trajectory[0].world_from_left = {Eigen::Quaterniond(world_from_left), {0.0, 0.5, 2.0}};
  const Camera camera{.width = 400, .height = 400, .fx = 400, .fy = 400, .cx = 199.5, .cy = 199.5};
  RasterInputs inputs;
  inputs.trajectory = &trajectory;
  inputs.left_camera = &camera;
  Write(cloud, inputs);
  const auto height = Height();
  const auto sigmas = Band(*height, 2), counts = Band(*height, 3), angles = Band(*height, 4);
  EXPECT_NEAR(sigmas[Index(0.01, 0.51)], 0.003F, 1e-6);
  EXPECT_EQ(counts[Index(0.01, 0.51)], 4.0F);
  // The normal leans by 6.4 degrees, the ray is plumb.
  EXPECT_NEAR(angles[Index(0.01, 0.51)], 6.4, 0.3);
  EXPECT_EQ(angles[Index(2.8, 0.51)], -9999.0F) << "not in the image";
}

TEST_F(Rasters, PassOverPointsThatAreNowhere) {
  PointCloud cloud = MapCloud(kCell);
  cloud.push_back(MapPoint(NAN, 0.0, 0.0));
  cloud.push_back(MapPoint(0.0, INFINITY, 0.0));
  Write(cloud);
  const auto values = Band(*Height(), 1);
  EXPECT_EQ(values.size(), 20000U);
  EXPECT_EQ(std::ranges::count(values, -9999.0F), 0);
}

TEST_F(Rasters, RefuseBadCloudsByNameAndLeaveTheOldFiles) {
  const auto ply = folder_.Path() / "dense.ply";
  const auto complaint = [&] {
    return MessageOf<DataError>([&] {
      WriteSurfaceRasters({ply, kCell}, folder_.Path(), options_, terrain_);
    });
  };
  WriteTestFile(folder_.Path() / "height.tif", "old");
  EXPECT_THAT(complaint(), HasSubstr("dense.ply: cannot read"));
  WriteTestFile(ply, "ply\nnonsense");
  EXPECT_THAT(complaint(), HasSubstr("dense.ply: expected"));
  WriteCloud(ply, {});
  EXPECT_THAT(complaint(), HasSubstr("dense.ply: expected points, found none"));
  EXPECT_THAT(NamesIn(folder_.Path()), UnorderedElementsAre("dense.ply", "height.tif"));
  EXPECT_EQ(ReadTextFile(folder_.Path() / "height.tif"), "old");
}

TEST_F(Rasters, LeaveNothingBehindWhenTheyCannotBeWritten) {
  RasterInputs nonsense;
  nonsense.grid = GridFrame{.epsg = 1};
  EXPECT_THROW(Write(MapCloud(kCell), nonsense), DataError);
  EXPECT_THAT(NamesIn(folder_.Path()), UnorderedElementsAre("dense.ply"));
}

TEST_F(Rasters, RefuseOptionsOutOfRange) {
  cell_m_ = 0.0;
  EXPECT_THROW(Write(MapCloud(kCell)), UsageError);
  cell_m_ = kCell;
  options_ = {.max_hole_cells = -1};
  EXPECT_THROW(Write(MapCloud(kCell)), UsageError);
  options_ = {};
  terrain_.footprint_m = 0.0;
  EXPECT_THROW(Write(MapCloud(kCell)), UsageError);
}

}  // namespace
}  // namespace rigmap
