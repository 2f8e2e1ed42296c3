#include "raster/geotiff.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_string.h>
#include <fmt/format.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/error.h"

namespace rigmap {
namespace {

constexpr GIntBig kCacheBytes = GIntBig{64} << 20;
constexpr const char* kLocalSystem = R"(LOCAL_CS["rigmap world",UNIT["metre",1]])";

void Require(bool done, const std::filesystem::path& path) {
  if (done) return;
  const std::string why = CPLGetLastErrorMsg();
  throw DataError(fmt::format("{}: cannot write: {}", path.string(),
                              why.empty() ? "GDAL gives no reason" : why));
}

GDALDriver& Driver(const char* name) {
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName(name);
  if (!driver) throw DataError(fmt::format("expected a GDAL with the {} driver, found none", name));
  return *driver;
}

struct MapBand {
  const char* name;
  const char* unit;  // empty: none
};

std::vector<MapBand> BandsOf(MapLayer layer) {
  switch (layer) {
    case MapLayer::kHeight:
      return {{"height", "metre"}, {"sigma", "metre"}, {"count", ""}, {"view_angle", "degree"}};
    case MapLayer::kColour:
      return {{"red", ""}, {"green", ""}, {"blue", ""}, {"alpha", ""}};
    case MapLayer::kTerrain:
      break;
  }
  return {{"slope", "degree"},
          {"roughness", "metre"},
          {"step_height", "metre"},
          {"slope_exceeds_limit", ""}};
}

std::unique_ptr<GDALDataset> CreateTiled(const std::filesystem::path& path, MapLayer layer,
                                         const CellFrame& frame) {
  CPLStringList options;
  options.SetNameValue("TILED", "YES");
  options.SetNameValue("BLOCKXSIZE", std::to_string(CellFrame::kTileCells).c_str());
  options.SetNameValue("BLOCKYSIZE", std::to_string(CellFrame::kTileCells).c_str());
  options.SetNameValue("SPARSE_OK", "TRUE");
  options.SetNameValue("BIGTIFF", "YES");
  options.SetNameValue("INTERLEAVE", "BAND");
  const bool colour = layer == MapLayer::kColour;
  if (colour) options.SetNameValue("PHOTOMETRIC", "RGB");
  if (colour) options.SetNameValue("ALPHA", "YES");
  CPLErrorReset();
  std::unique_ptr<GDALDataset> dataset(Driver("GTiff").Create(
      path.string().c_str(), frame.columns, frame.rows, static_cast<int>(BandsOf(layer).size()),
      colour ? GDT_Byte : GDT_Float32, options.List()));
  Require(dataset != nullptr, path);
  return dataset;
}

// Of the cell's corners, in GDAL's order.
std::array<double, 6> GeoTransform(const CellFrame& frame) {
  const Eigen::Vector2d corner = frame.UpperLeft();
  return {corner.x(), frame.cell_m, 0.0, corner.y(), 0.0, -frame.cell_m};
}

std::vector<std::uint8_t> Colours(const SurfaceGrid& grid) {
  std::vector<std::uint8_t> rgba;
  rgba.reserve(4 * grid.rgb.size());
  for (std::size_t i = 0; i < grid.rgb.size(); ++i) {
    rgba.insert(rgba.end(), grid.rgb[i].begin(), grid.rgb[i].end());
    rgba.push_back(std::isnan(grid.height_m[i]) ? 0 : 255);
  }
  return rgba;
}

// One band of the layer kHeight, from 0, for a cell in which something was seen.
float HeightBand(const SurfaceGrid& grid, std::size_t cell, int band) {
  if (band == 0) return grid.height_m[cell];
  if (grid.quality.empty()) return std::numeric_limits<float>::quiet_NaN();
  const CellQuality& quality = grid.quality[cell];
  return band == 1 ? quality.sigma_m : band == 2 ? quality.count : quality.view_deg;
}

std::mutex& SessionMutex() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace

GdalSession::GdalSession() : alone_(SessionMutex()), previous_cache_bytes_(GDALGetCacheMax64()) {
  GDALAllRegister();
  CPLPushErrorHandler(CPLQuietErrorHandler);
  CPLSetThreadLocalConfigOption("GDAL_PAM_ENABLED", "NO");
  GDALSetCacheMax64(kCacheBytes);
}

GdalSession::~GdalSession() {
  GDALSetCacheMax64(previous_cache_bytes_);
  CPLSetThreadLocalConfigOption("GDAL_PAM_ENABLED", nullptr);
  CPLPopErrorHandler();
}

MapFile::MapFile(const std::filesystem::path& path, MapLayer layer, const CellFrame& frame,
                 const MapNotes& notes)
    : path_(path), layer_(layer), dataset_(CreateTiled(path, layer, frame)) {
  Describe(frame, notes);
}

MapFile::~MapFile() = default;

void MapFile::Describe(const CellFrame& frame, const MapNotes& notes) {
  CPLErrorReset();
  auto transform = GeoTransform(frame);
  Require(dataset_->SetGeoTransform(transform.data()) == CE_None, path_);
  OGRSpatialReference system;
  Require((notes.epsg == 0 ? system.importFromWkt(kLocalSystem)
                           : system.importFromEPSG(notes.epsg)) == OGRERR_NONE,
          path_);
  Require(dataset_->SetSpatialRef(&system) == CE_None, path_);
  const auto bands = BandsOf(layer_);
  for (std::size_t i = 0; i < bands.size(); ++i) {
    GDALRasterBand& band = *dataset_->GetRasterBand(static_cast<int>(i) + 1);
    band.SetDescription(bands[i].name);
    if (layer_ == MapLayer::kColour) continue;
    Require(band.SetNoDataValue(kNoHeight) == CE_None, path_);
    if (*bands[i].unit) Require(band.SetUnitType(bands[i].unit) == CE_None, path_);
  }
  auto items = notes.items;
  if (!notes.warning.empty()) {
    items.emplace_back("RIGMAP_VERDICT", notes.warning);
    items.emplace_back("TIFFTAG_IMAGEDESCRIPTION", notes.warning);
  }
  for (const auto& [name, value] : items) {
    Require(dataset_->SetMetadataItem(name.c_str(), value.c_str()) == CE_None, path_);
  }
}

void MapFile::WriteTile(int tile_column, int tile_row, const SurfaceGrid& grid, int margin) {
  CellWindow window{tile_column * CellFrame::kTileCells, tile_row * CellFrame::kTileCells};
  window.columns = std::min(CellFrame::kTileCells, dataset_->GetRasterXSize() - window.column);
  window.rows = std::min(CellFrame::kTileCells, dataset_->GetRasterYSize() - window.row);
  if (layer_ == MapLayer::kColour) {
    auto cells = Colours(grid);
    CPLErrorReset();
    Require(dataset_->RasterIO(GF_Write, window.column, window.row, window.columns, window.rows,
                               cells.data() + grid.Index(margin, margin) * 4, window.columns,
                               window.rows, GDT_Byte, 4, nullptr, 4, GSpacing{4} * grid.columns, 1,
                               nullptr) == CE_None,
            path_);
    return;
  }
  for (int band = 0; band < 4; ++band) {
    std::vector<float> values;
    for (int row = 0; row < window.rows; ++row) {
      for (int column = 0; column < window.columns; ++column) {
        const std::size_t cell = grid.Index(column + margin, row + margin);
        values.push_back(std::isnan(grid.height_m[cell]) ? grid.height_m[cell]
                                                         : HeightBand(grid, cell, band));
      }
    }
    WriteBand(band + 1, window, std::move(values));
  }
}

void MapFile::WriteBand(int band, const CellWindow& window, std::vector<float> values) {
  for (float& value : values) {
    if (std::isnan(value)) value = kNoHeight;
  }
  CPLErrorReset();
  Require(dataset_->GetRasterBand(band)->RasterIO(
              GF_Write, window.column, window.row, window.columns, window.rows, values.data(),
              window.columns, window.rows, GDT_Float32, 0, 0, nullptr) == CE_None,
          path_);
}

std::vector<float> MapFile::ReadBand(int band, const CellWindow& window) {
  std::vector<float> values(static_cast<std::size_t>(window.columns) * window.rows);
  CPLErrorReset();
  Require(dataset_->GetRasterBand(band)->RasterIO(
              GF_Read, window.column, window.row, window.columns, window.rows, values.data(),
              window.columns, window.rows, GDT_Float32, 0, 0, nullptr) == CE_None,
          path_);
  for (float& value : values) {
    if (value == kNoHeight) value = std::numeric_limits<float>::quiet_NaN();
  }
  return values;
}

void MapFile::SaveCloudOptimised(const std::filesystem::path& path) {
  CPLStringList options;
  options.SetNameValue("COMPRESS", "DEFLATE");
  options.SetNameValue("PREDICTOR", "YES");
  options.SetNameValue("BLOCKSIZE", std::to_string(CellFrame::kTileCells).c_str());
  options.SetNameValue("OVERVIEW_RESAMPLING", "AVERAGE");
  options.SetNameValue("OVERVIEWS", "IGNORE_EXISTING");
  options.SetNameValue("SPARSE_OK", "YES");
  options.SetNameValue("BIGTIFF", "IF_SAFER");
  // For what is compressed; the bytes do not depend on it.
  options.SetNameValue("NUM_THREADS",
                       std::to_string(tbb::this_task_arena::max_concurrency()).c_str());
  CPLErrorReset();
  dataset_->FlushCache(false);
  Require(CPLGetLastErrorType() < CE_Failure, path_);
  std::unique_ptr<GDALDataset> saved(Driver("COG").CreateCopy(
      path.string().c_str(), dataset_.get(), false, options.List(), nullptr, nullptr));
  Require(saved != nullptr, path);
  saved.reset();  // what it still holds is written now
  Require(CPLGetLastErrorType() < CE_Failure, path);
}

}  // namespace rigmap
