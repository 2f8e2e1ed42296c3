// A map seen from above: cells of 2 cm, kept only where there are points.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <span>

#include "geometry/tile_index.h"
#include "scene/point_cloud.h"

namespace rigmap {

inline constexpr double kHeightCell_m = 0.02;
inline constexpr int kTileCells = 16;  // along a tile's edge: 0.32 m

struct HeightCell {
  float top_m = -std::numeric_limits<float>::infinity();
  float mean_m = 0.0F;
  std::uint32_t points = 0;
};

using CellIndex = TileIndex;  // of cells rather than of tiles of cells
using HeightTile = std::array<HeightCell, std::size_t{kTileCells} * kTileCells>;

// Heights (world z, metres) of points by their horizontal place. Takes 3 kB per tile touched: about
// 35 kB per square metre of map, whatever the number of points. Points may be added piece by piece.
class HeightGrid {
 public:
  // Points that are not finite, or further than 1000 km from the origin, are passed over.
  void Add(std::span<const SurfacePoint> points);

  // The cell, or nullptr where no point fell.
  const HeightCell* Find(const CellIndex& cell) const;

  const std::map<TileIndex, HeightTile>& tiles() const { return tiles_; }

 private:
  std::map<TileIndex, HeightTile> tiles_;
};

TileIndex TileOf(const Eigen::Vector2d& x_in_world);
// Cell `index` (0 to 255, row by row) of a tile.
CellIndex CellOfTile(const TileIndex& tile, std::size_t index);
Eigen::Vector2d CentreOf(const CellIndex& cell);

// Where the ground would be without rocks. One plane per tile.
class GroundLevel {
 public:
  // Around each tile, over a window wider than the largest rock, a plane that most of the lower
  // half of the cells agrees with: rocks rise above it, whatever their number of cells.
  explicit GroundLevel(const HeightGrid& grid);

  // World z, metres; nothing in a tile without enough cells.
  std::optional<double> At(const Eigen::Vector2d& x_in_world) const;
  // Of the nearest tile that has one; nothing for an empty map.
  std::optional<double> Near(const Eigen::Vector2d& x_in_world) const;

 private:
  struct Plane {
    Eigen::Vector2d centre = Eigen::Vector2d::Zero();
    Eigen::Vector3d coefficients = Eigen::Vector3d::Zero();  // slope along x, along y, height
    double At(const Eigen::Vector2d& x_in_world) const;
  };
  std::map<TileIndex, Plane> planes_;
};

}  // namespace rigmap
