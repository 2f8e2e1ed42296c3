// Where the cells of a map lie in world, and how the map is cut into tiles.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>

namespace rigmap {

// North-up: columns grow with x, rows with falling y. The borders of cells are at multiples of
// cell_m, as those of voxels of that size.
struct CellFrame {
  static constexpr int kTileCells = 512;  // side of a tile

  double cell_m = 0.0;
  std::int64_t west = 0;   // of column 0, in cells from the world's origin
  std::int64_t north = 0;  // of row 0: its cells reach from y = north cells up to north + 1
  int columns = 0;
  int rows = 0;

  int Column(double x_m) const;
  int Row(double y_m) const;
  // World's x and y of the upper left corner of the upper left cell.
  Eigen::Vector2d UpperLeft() const;

  int TilesAcross() const { return (columns + kTileCells - 1) / kTileCells; }
  int TilesDown() const { return (rows + kTileCells - 1) / kTileCells; }
};

// A cloud in metres, z up, in any order. Its cells are the voxels it was merged in: finer ones
// leave holes between the points, coarser ones lose detail.
struct GriddedCloud {
  std::filesystem::path ply;
  double cell_m = 0.0;
  std::string warning = {};  // what everything made of it has to bear; empty: nothing

  void Validate() const;  // throws UsageError for cells that are none
};

// The smallest frame that holds all finite points of a cloud. Throws DataError naming the file for
// a cloud that cannot be read or has no such point, and for one whose map would have more than 1e11
// cells.
CellFrame FrameOf(const GriddedCloud& cloud);

}  // namespace rigmap
