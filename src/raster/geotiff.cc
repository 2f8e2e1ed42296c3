#include "raster/geotiff.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_string.h>
#include <fmt/format.h>
#include <gdal_priv.h>

#include <algorithm>
#include <array>
#include <cmath>
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

std::unique_ptr<GDALDataset> CreateTiled(const std::filesystem::path& path, MapLayer layer,
                                         const CellFrame& frame) {
  CPLStringList options;
  options.SetNameValue("TILED", "YES");
  options.SetNameValue("BLOCKXSIZE", std::to_string(CellFrame::kTileCells).c_str());
  options.SetNameValue("BLOCKYSIZE", std::to_string(CellFrame::kTileCells).c_str());
  options.SetNameValue("SPARSE_OK", "TRUE");
  options.SetNameValue("BIGTIFF", "YES");
  const bool colour = layer == MapLayer::kColour;
  if (colour) options.SetNameValue("PHOTOMETRIC", "RGB");
  if (colour) options.SetNameValue("ALPHA", "YES");
  CPLErrorReset();
  std::unique_ptr<GDALDataset> dataset(
      Driver("GTiff").Create(path.string().c_str(), frame.columns, frame.rows, colour ? 4 : 1,
                             colour ? GDT_Byte : GDT_Float32, options.List()));
  Require(dataset != nullptr, path);
  return dataset;
}

// Of the cell's corners, in GDAL's order.
std::array<double, 6> GeoTransform(const CellFrame& frame, const Eigen::Affine2d& map_from_world) {
  const Eigen::Vector2d corner = map_from_world * frame.UpperLeft();
  const Eigen::Matrix2d map_from_cells =
      map_from_world.linear() * Eigen::Vector2d(frame.cell_m, -frame.cell_m).asDiagonal();
  return {corner.x(), map_from_cells(0, 0), map_from_cells(0, 1),
          corner.y(), map_from_cells(1, 0), map_from_cells(1, 1)};
}

// As GDAL wants the cells: floats, or red, green, blue and alpha.
std::vector<float> Heights(const SurfaceGrid& grid) {
  std::vector<float> heights = grid.height_m;
  for (float& height : heights) {
    if (std::isnan(height)) height = kNoHeight;
  }
  return heights;
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
                 const Georeference& georeference, const std::string& warning)
    : path_(path), layer_(layer), dataset_(CreateTiled(path, layer, frame)) {
  Describe(frame, georeference);
  if (warning.empty()) return;
  for (const char* item : {"RIGMAP_VERDICT", "TIFFTAG_IMAGEDESCRIPTION"}) {
    Require(dataset_->SetMetadataItem(item, warning.c_str()) == CE_None, path_);
  }
}

MapFile::~MapFile() = default;

void MapFile::Describe(const CellFrame& frame, const Georeference& georeference) {
  CPLErrorReset();
  auto transform = GeoTransform(frame, georeference.map_from_world);
  Require(dataset_->SetGeoTransform(transform.data()) == CE_None, path_);
  const char* wkt = georeference.wkt.empty() ? kLocalSystem : georeference.wkt.c_str();
  Require(dataset_->SetProjection(wkt) == CE_None, path_);
  if (layer_ == MapLayer::kHeight) {
    GDALRasterBand& band = *dataset_->GetRasterBand(1);
    Require(band.SetNoDataValue(kNoHeight) == CE_None, path_);
    band.SetDescription("height");
    Require(band.SetUnitType("metre") == CE_None, path_);
    return;
  }
  const std::array<const char*, 4> names{"red", "green", "blue", "alpha"};
  for (int i = 0; i < 4; ++i) dataset_->GetRasterBand(i + 1)->SetDescription(names[i]);
}

void MapFile::WriteTile(int tile_column, int tile_row, const SurfaceGrid& grid, int margin) {
  const int first_column = tile_column * CellFrame::kTileCells;
  const int first_row = tile_row * CellFrame::kTileCells;
  const int columns = std::min(CellFrame::kTileCells, dataset_->GetRasterXSize() - first_column);
  const int rows = std::min(CellFrame::kTileCells, dataset_->GetRasterYSize() - first_row);
  const auto write = [&](auto cells, GDALDataType type, int channels) {
    const auto value_bytes = static_cast<GSpacing>(sizeof(cells[0]));
    return dataset_->RasterIO(GF_Write, first_column, first_row, columns, rows,
                              cells.data() + grid.Index(margin, margin) * channels, columns, rows,
                              type, channels, nullptr, value_bytes * channels,
                              value_bytes * channels * grid.columns, value_bytes, nullptr);
  };
  CPLErrorReset();
  const bool heights = layer_ == MapLayer::kHeight;
  Require((heights ? write(Heights(grid), GDT_Float32, 1) : write(Colours(grid), GDT_Byte, 4)) ==
              CE_None,
          path_);
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
