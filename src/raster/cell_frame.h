// Where the cells of a map lie, in the world or on a grid of the Earth, and how the map is cut into
// tiles.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "georeference/earth_frame.h"
#include "scene/point_cloud.h"

namespace rigmap {

// North-up: columns grow with x, rows with falling y. The borders of cells are at multiples of
// cell_m, as those of voxels of that size.
struct CellFrame {
  static constexpr int kTileCells = 512;  // side of a tile

  double cell_m = 0.0;
  std::int64_t west = 0;   // of column 0, in cells from the origin of world or grid
  std::int64_t north = 0;  // of row 0: its cells reach from y = north cells up to north + 1
  int columns = 0;
  int rows = 0;

  int Column(double x_m) const;
  int Row(double y_m) const;
  // x and y of the upper left corner of the upper left cell.
  Eigen::Vector2d UpperLeft() const;

  int TilesAcross() const { return (columns + kTileCells - 1) / kTileCells; }
  int TilesDown() const { return (rows + kTileCells - 1) / kTileCells; }
};

// A cloud in metres, z up, in any order. Its cells are the finest voxels it was merged in: finer
// ones leave holes between the points, coarser ones lose detail.
struct GriddedCloud {
  std::filesystem::path ply;
  double cell_m = 0.0;
  std::string warning = {};  // what everything made of it has to bear; empty: nothing

  void Validate() const;  // throws UsageError for cells that are none
};

// Calls `take` with the finite points of a cloud that stand for no more than kMostCells cells to a
// side (or, where all stand for more, times the side of the finest): what is coarser lies too far
// away to be drawn to the scale of the rest. Throws DataError for a cloud that cannot be read.
inline constexpr double kMostCells = 8.0;
void ForEachShown(const GriddedCloud& cloud, const std::function<void(const SurfacePoint&)>& take);

// The smallest frame that holds all points of a cloud that are shown, in the world or on `grid`.
// Of a cloud whose map would have more than 2e9 cells, they are larger by a power of two, which is
// logged. Throws DataError naming the file for a cloud that cannot be read or has no such point.
CellFrame FrameOf(const GriddedCloud& cloud, const std::optional<GridFrame>& grid = {});

}  // namespace rigmap
