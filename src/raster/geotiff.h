// The two GeoTIFF files of a map, through GDAL, tile by tile.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>

#include "raster/cell_frame.h"
#include "raster/upper_surface.h"

class GDALDataset;  // of GDAL

namespace rigmap {

constexpr float kNoHeight = -9999.0F;  // the nodata value of height files

// Where a map's world lies on Earth, or wherever its coordinate system says.
struct Georeference {
  std::string wkt;  // of a system in metres; empty: an unreferenced local one
  Eigen::Affine2d map_from_world = Eigen::Affine2d::Identity();
};

// While it lives: GDAL is silent, caches at most 64 MB of pixels, and writes no .aux.xml. Its cache
// is the process's, its silence the thread's: a second session waits until the first has ended.
class GdalSession {
 public:
  GdalSession();
  ~GdalSession();
  GdalSession(const GdalSession&) = delete;
  GdalSession& operator=(const GdalSession&) = delete;

 private:
  std::unique_lock<std::mutex> alone_;
  std::int64_t previous_cache_bytes_;
};

enum class MapLayer { kHeight, kColour };

// A map in the making: an uncompressed tiled file in which only the tiles written take space.
// Height: one Float32 band "height" in metres; colour: red, green, blue and alpha, 8 bit each. All
// throw DataError naming the file when GDAL fails. A GdalSession must live.
class MapFile {
 public:
  // `warning`, unless it is empty, becomes the metadata RIGMAP_VERDICT and the file's standard
  // description.
  MapFile(const std::filesystem::path& path, MapLayer layer, const CellFrame& frame,
          const Georeference& georeference, const std::string& warning = {});
  ~MapFile();

  // Writes those cells of the grid, whose first `margin` columns and rows lie before the tile, that
  // are inside the tile.
  void WriteTile(int tile_column, int tile_row, const SurfaceGrid& grid, int margin);

  // Writes the map as cloud-optimised GeoTIFF: tiles of 512, overviews by averaging, lossless.
  void SaveCloudOptimised(const std::filesystem::path& path);

 private:
  void Describe(const CellFrame& frame, const Georeference& georeference);

  std::filesystem::path path_;
  MapLayer layer_;
  std::unique_ptr<GDALDataset> dataset_;
};

}  // namespace rigmap
