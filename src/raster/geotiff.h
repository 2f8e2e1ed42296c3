// The GeoTIFF files of a map, through GDAL, tile by tile.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "raster/cell_frame.h"
#include "raster/upper_surface.h"

class GDALDataset;  // of GDAL

namespace rigmap {

constexpr float kNoHeight = -9999.0F;  // the nodata value of files with floats

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

// kHeight: Float32 bands "height" and "sigma" in metres, "count", "view_angle" in degrees. kColour:
// red, green, blue and alpha, 8 bit each. kTerrain: Float32 bands "slope" in degrees, "roughness"
// and "step_height" in metres, "slope_exceeds_limit", a probability. Nodata of floats is kNoHeight.
enum class MapLayer { kHeight, kColour, kTerrain };

// What a file says of itself.
struct MapNotes {
  int epsg = 0;  // of the grid that the frame's metres are of; 0: an unreferenced local one
  std::string warning = {};  // metadata RIGMAP_VERDICT and the file's standard description
  std::vector<std::pair<std::string, std::string>> items = {};  // more metadata: name, value
};

// Cells of a map: the first column and row, and how many.
struct CellWindow {
  int column = 0, row = 0, columns = 0, rows = 0;
};

// A map in the making: an uncompressed tiled file in which only the tiles written take space. All
// throw DataError naming the file when GDAL fails. A GdalSession must live.
class MapFile {
 public:
  MapFile(const std::filesystem::path& path, MapLayer layer, const CellFrame& frame,
          const MapNotes& notes = {});
  ~MapFile();

  // Writes those cells of the grid, whose first `margin` columns and rows lie before the tile, that
  // are inside the tile. For kHeight and kColour.
  void WriteTile(int tile_column, int tile_row, const SurfaceGrid& grid, int margin);

  // Values of one band (from 1), row by row, NaN where there is none. For kHeight and kTerrain.
  void WriteBand(int band, const CellWindow& window, std::vector<float> values);
  std::vector<float> ReadBand(int band, const CellWindow& window);

  // Writes the map as cloud-optimised GeoTIFF: tiles of 512, overviews by averaging, lossless.
  void SaveCloudOptimised(const std::filesystem::path& path);

 private:
  void Describe(const CellFrame& frame, const MapNotes& notes);

  std::filesystem::path path_;
  MapLayer layer_;
  std::unique_ptr<GDALDataset> dataset_;
};

}  // namespace rigmap
