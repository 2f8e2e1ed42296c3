// Points sorted into the tiles of a map on disk, for clouds in any order and larger than the
// memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <span>
#include <vector>

#include "raster/cell_frame.h"
#include "raster/internal/point_cells.h"
#include "raster/upper_surface.h"
#include "scene/point_cloud.h"

namespace rigmap {

struct BinnedPoint {
  // Within the tile and its margin: 0 is `margin` cells west or north of the tile.
  std::uint16_t column = 0;
  std::uint16_t row = 0;
  CellSample sample;
};

class PointBins {
 public:
  // Makes the file `scratch`, which the caller removes. `margin`: cells around each tile whose
  // points the tile holds too.
  PointBins(const PointCells& cells, int margin, const std::filesystem::path& scratch);

  // In all cells of the frame that the point stands for (PointCells). Up to 32 MB
  // wait in memory before they go to the file. Throws DataError when it cannot be written.
  void Add(const SurfacePoint& point);
  void Flush();  // to be called after the last Add

  // True if any point lies in the tile or its margin.
  bool HasPoints(int tile_column, int tile_row) const;
  // The points of a tile in the order in which they were added. Throws DataError.
  void ForEach(int tile_column, int tile_row,
               const std::function<void(std::span<const BinnedPoint>)>& take);

  int margin() const { return margin_; }

 private:
  struct Chunk {
    std::uint64_t first = 0;  // points before it in the file
    std::uint32_t count = 0;
  };

  std::size_t TileIndex(int tile_column, int tile_row) const;
  void AddAt(const CellSample& sample, int column, int row);

  PointCells cells_;
  CellFrame frame_;
  int margin_;
  std::filesystem::path scratch_;
  std::fstream file_;
  std::vector<std::vector<Chunk>> chunks_;         // by tile
  std::vector<std::vector<BinnedPoint>> waiting_;  // by tile
  std::size_t waiting_count_ = 0;
  std::uint64_t written_count_ = 0;
};

}  // namespace rigmap
