// Squares that a plane is cut into, by number.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace rigmap {

// Along x, along y. The tile {0, 0} has its lower corner at the origin and holds its lower edges.
using TileIndex = std::pair<std::int64_t, std::int64_t>;

// The number of the tile, `size` wide, that holds a coordinate. Coordinates beyond 1e15 tiles, or
// NaN, are taken to the outermost.
inline std::int64_t TileAlong(double coordinate, double size) {
  constexpr double kOutermost = 1e15;  // a double tells all whole numbers up to here
  const double tile = std::floor(coordinate / size);
  return static_cast<std::int64_t>(std::fmax(-kOutermost, std::fmin(tile, kOutermost)));
}

inline TileIndex TileAt(const Eigen::Vector2d& position, double size) {
  return {TileAlong(position.x(), size), TileAlong(position.y(), size)};
}

// The tile, `cells` cells wide, that holds a cell: rounds towards minus infinity.
inline std::int64_t TileOfCell(std::int64_t cell, std::int64_t cells) {
  return (cell >= 0 ? cell : cell - cells + 1) / cells;
}

// For std::unordered_map.
struct TileHash {
  std::size_t operator()(const TileIndex& tile) const {
    return (static_cast<std::size_t>(tile.second) << 32U) ^
           static_cast<std::size_t>(static_cast<std::uint32_t>(tile.first));
  }
};

}  // namespace rigmap
