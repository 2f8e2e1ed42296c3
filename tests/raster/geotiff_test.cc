#include "raster/geotiff.h"

#include <gdal_priv.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ogr_spatialref.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/error.h"
#include "tests/support/message_of.h"
#include "tests/support/seeded_random.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

constexpr int kMargin = 3;
constexpr int kTile = CellFrame::kTileCells;
// Two tiles side by side, both cut below, the second at its side too.
constexpr CellFrame kFrame{.cell_m = 0.02, .west = -100, .north = 49, .columns = 600, .rows = 100};

// A tile with its margin, in which every third cell was not seen.
SurfaceGrid RandomTile(SeededRandom& random) {
  SurfaceGrid grid{kTile + 2 * kMargin, kTile + 2 * kMargin, {}, {}};
  for (int i = 0; i < grid.columns * grid.rows; ++i) {
    const bool seen = i % 3 != 0;
    grid.height_m.push_back(seen ? static_cast<float>(random.Uniform(-5.0, 5.0))
                                 : std::numeric_limits<float>::quiet_NaN());
    const auto level = static_cast<std::uint8_t>(random.Uniform(0.0, 256.0));
    grid.rgb.push_back(seen ? std::array<std::uint8_t, 3>{level, 7, 9}
                            : std::array<std::uint8_t, 3>{});
  }
  return grid;
}

class GeoTiffTest : public testing::Test {
 protected:
  // The tiles through a map in the making and a finished one, and open again.
  std::unique_ptr<GDALDataset> Saved(MapLayer layer, const std::vector<SurfaceGrid>& tiles,
                                     const MapNotes& notes = {}) {
    const GdalSession session;
    MapFile map(folder_.Path() / "unfinished", layer, kFrame, notes);
    for (std::size_t i = 0; i < tiles.size(); ++i) {
      map.WriteTile(static_cast<int>(i), 0, tiles[i], kMargin);
    }
    map.SaveCloudOptimised(path_);
    GDALAllRegister();
    return std::unique_ptr<GDALDataset>(GDALDataset::Open(path_.string().c_str(), GDAL_OF_RASTER));
  }
  static std::vector<float> Band(GDALDataset& dataset, int band) {
    std::vector<float> values(static_cast<std::size_t>(kFrame.columns) * kFrame.rows);
    EXPECT_EQ(dataset.GetRasterBand(band)->RasterIO(GF_Read, 0, 0, kFrame.columns, kFrame.rows,
                                                    values.data(), kFrame.columns, kFrame.rows,
                                                    GDT_Float32, 0, 0),
              CE_None);
    return values;
  }

  SeededRandom random_;
  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.Path() / "map.tif";
};

TEST_F(GeoTiffTest, HeightsComeBackCellByCell) {
  const std::vector<SurfaceGrid> tiles{RandomTile(random_), RandomTile(random_)};
  const auto dataset = Saved(MapLayer::kHeight, tiles);
  ASSERT_TRUE(dataset);
  ASSERT_EQ(dataset->GetRasterXSize(), kFrame.columns);
  ASSERT_EQ(dataset->GetRasterYSize(), kFrame.rows);
  EXPECT_EQ(dataset->GetRasterBand(1)->GetNoDataValue(), kNoHeight);
  const std::vector<float> found = Band(*dataset, 1);
  for (int row = 0; row < kFrame.rows; ++row) {
    for (int column = 0; column < kFrame.columns; ++column) {
      const SurfaceGrid& tile = tiles[static_cast<std::size_t>(column / kTile)];
      const float height_m =
          tile.height_m[tile.Index(column % kTile + kMargin, row % kTile + kMargin)];
      ASSERT_EQ(found[static_cast<std::size_t>(row) * kFrame.columns + column],
                std::isnan(height_m) ? kNoHeight : height_m)
          << column << ", " << row;
    }
  }
}

TEST_F(GeoTiffTest, ColoursAreTransparentWhereNothingWasSeen) {
  const SurfaceGrid tile = RandomTile(random_);
  const auto dataset = Saved(MapLayer::kColour, {tile});
  ASSERT_TRUE(dataset);
  ASSERT_EQ(dataset->GetRasterCount(), 4);
  const auto red = Band(*dataset, 1), green = Band(*dataset, 2), alpha = Band(*dataset, 4);
  for (int column = 0; column < kTile; ++column) {
    const std::size_t cell = tile.Index(column + kMargin, kMargin);
    const bool seen = !std::isnan(tile.height_m[cell]);
    ASSERT_EQ(alpha[static_cast<std::size_t>(column)], seen ? 255.0F : 0.0F) << column;
    ASSERT_EQ(red[static_cast<std::size_t>(column)], tile.rgb[cell][0]) << column;
    ASSERT_EQ(green[static_cast<std::size_t>(column)], tile.rgb[cell][1]) << column;
  }
  EXPECT_EQ(alpha[static_cast<std::size_t>(kTile)], 0.0F) << "a tile that was never written";
}

// GDAL's transform takes a cell's corner to the map; north is up.
TEST_F(GeoTiffTest, CellsLieWhereTheFramePutsThemInItsSystem) {
  for (const int epsg : {0, 32631, 32719}) {
    const auto dataset = Saved(MapLayer::kTerrain, {}, {epsg});
    ASSERT_TRUE(dataset);
    std::array<double, 6> t{};
    ASSERT_EQ(dataset->GetGeoTransform(t.data()), CE_None);
    const std::array<double, 6> expected{kFrame.UpperLeft().x(), kFrame.cell_m, 0.0,
                                         kFrame.UpperLeft().y(), 0.0,           -kFrame.cell_m};
    for (int i = 0; i < 6; ++i) EXPECT_NEAR(t[i], expected[i], 1e-12);
    const OGRSpatialReference* system = dataset->GetSpatialRef();
    ASSERT_TRUE(system);
    EXPECT_EQ(system->IsLocal(), epsg == 0);
    if (epsg != 0) {
      EXPECT_STREQ(system->GetAuthorityCode(nullptr), std::to_string(epsg).c_str());
    }
  }
}

TEST_F(GeoTiffTest, BandsHaveNamesAndUnits) {
  const std::array<const char*, 4> height{"height", "sigma", "count", "view_angle"};
  const std::array<const char*, 4> terrain{"slope", "roughness", "step_height",
                                           "slope_exceeds_limit"};
  const auto heights = Saved(MapLayer::kHeight, {}), grounds = Saved(MapLayer::kTerrain, {});
  for (int i = 0; i < 4; ++i) {
    EXPECT_STREQ(heights->GetRasterBand(i + 1)->GetDescription(), height[i]);
    EXPECT_STREQ(grounds->GetRasterBand(i + 1)->GetDescription(), terrain[i]);
    EXPECT_EQ(grounds->GetRasterBand(i + 1)->GetNoDataValue(), kNoHeight);
  }
  EXPECT_STREQ(heights->GetRasterBand(4)->GetUnitType(), "degree");
  EXPECT_STREQ(grounds->GetRasterBand(3)->GetUnitType(), "metre");
}

TEST_F(GeoTiffTest, BandsAreWrittenAndReadBackByWindows) {
  const GdalSession session;
  MapFile map(folder_.Path() / "unfinished", MapLayer::kTerrain, kFrame);
  const CellWindow window{500, 10, 30, 2};
  std::vector<float> values(60, 2.5F);
  values[7] = std::numeric_limits<float>::quiet_NaN();
  map.WriteBand(3, window, values);
  const std::vector<float> found = map.ReadBand(3, window);
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_EQ(std::isnan(found[i]), i == 7);
    if (i != 7) {
      EXPECT_EQ(found[i], values[i]);
    }
  }
  EXPECT_TRUE(std::isnan(map.ReadBand(3, {0, 0, 1, 1})[0])) << "never written";
}

TEST_F(GeoTiffTest, AWarningIsMetadataAndTheFilesDescription) {
  for (const MapLayer layer : {MapLayer::kHeight, MapLayer::kColour}) {
    const auto trusted = Saved(layer, {});
    EXPECT_EQ(trusted->GetMetadataItem("RIGMAP_VERDICT"), nullptr);
    EXPECT_EQ(trusted->GetMetadataItem("TIFFTAG_IMAGEDESCRIPTION"), nullptr);
    const auto dataset = Saved(layer, {}, {0, "not trusted: a"});
    EXPECT_STREQ(dataset->GetMetadataItem("RIGMAP_VERDICT"), "not trusted: a");
    EXPECT_STREQ(dataset->GetMetadataItem("TIFFTAG_IMAGEDESCRIPTION"), "not trusted: a");
  }
}

TEST_F(GeoTiffTest, FilesThatCannotBeWrittenAreNamed) {
  const GdalSession session;
  const auto nowhere = folder_.Path() / "none" / "map.tif";
  EXPECT_THAT(MessageOf<DataError>([&] { MapFile(nowhere, MapLayer::kHeight, kFrame); }),
              testing::HasSubstr(nowhere.string()));
  MapFile map(folder_.Path() / "unfinished", MapLayer::kHeight, kFrame);
  EXPECT_THAT(MessageOf<DataError>([&] { map.SaveCloudOptimised(nowhere); }),
              testing::HasSubstr(nowhere.string()));
}

TEST(GdalSession, GivesBackTheCacheItFound) {
  const auto before = GDALGetCacheMax64();
  {
    const GdalSession session;
    EXPECT_EQ(GDALGetCacheMax64(), std::int64_t{64} << 20);
  }
  EXPECT_EQ(GDALGetCacheMax64(), before);
}

}  // namespace
}  // namespace rigmap
