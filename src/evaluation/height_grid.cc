#include "evaluation/height_grid.h"

#include <algorithm>

namespace rigmap {
namespace {

constexpr float kMaxCoordinate_m = 1.0e6F;

std::size_t IndexInTile(const CellIndex& cell, const TileIndex& tile) {
  return static_cast<std::size_t>((cell.second - tile.second * kTileCells) * kTileCells +
                                  cell.first - tile.first * kTileCells);
}

CellIndex CellOf(const Eigen::Vector2d& x_in_world) { return TileAt(x_in_world, kHeightCell_m); }

TileIndex TileHolding(const CellIndex& cell) {
  return {TileOfCell(cell.first, kTileCells), TileOfCell(cell.second, kTileCells)};
}

}  // namespace

void HeightGrid::Add(std::span<const SurfacePoint> points) {
  HeightTile* tile = nullptr;
  TileIndex tile_index;
  for (const SurfacePoint& point : points) {
    const Eigen::Vector3f& x = point.x_in_world;
    if (!x.allFinite() || x.cwiseAbs().maxCoeff() > kMaxCoordinate_m) continue;
    const CellIndex cell_index = CellOf(x.head<2>().cast<double>());
    const TileIndex index = TileHolding(cell_index);
    if (tile == nullptr || index != tile_index) {
      tile = &tiles_[index];
      tile_index = index;
    }
    HeightCell& cell = (*tile)[IndexInTile(cell_index, index)];
    ++cell.points;
    cell.top_m = std::max(cell.top_m, x.z());
    cell.mean_m += (x.z() - cell.mean_m) / static_cast<float>(cell.points);
  }
}

const HeightCell* HeightGrid::Find(const CellIndex& cell) const {
  const TileIndex index = TileHolding(cell);
  const auto tile = tiles_.find(index);
  if (tile == tiles_.end()) return nullptr;
  const HeightCell& found = tile->second[IndexInTile(cell, index)];
  return found.points > 0 ? &found : nullptr;
}

TileIndex TileOf(const Eigen::Vector2d& x_in_world) { return TileHolding(CellOf(x_in_world)); }

CellIndex CellOfTile(const TileIndex& tile, std::size_t index) {
  const auto i = static_cast<std::int64_t>(index);
  return {tile.first * kTileCells + i % kTileCells, tile.second * kTileCells + i / kTileCells};
}

Eigen::Vector2d CentreOf(const CellIndex& cell) {
  return {(static_cast<double>(cell.first) + 0.5) * kHeightCell_m,
          (static_cast<double>(cell.second) + 0.5) * kHeightCell_m};
}

}  // namespace rigmap
