#include "evaluation/height_grid.h"

#include <cmath>

namespace rigmap {
namespace {

constexpr float kMaxCoordinate_m = 1.0e6F;

// Rounds towards minus infinity.
std::int32_t TileOfCell(std::int32_t cell) {
  return (cell >= 0 ? cell : cell - kTileCells + 1) / kTileCells;
}

std::size_t IndexInTile(const CellIndex& cell, const TileIndex& tile) {
  return static_cast<std::size_t>((cell.second - tile.second * kTileCells) * kTileCells +
                                  cell.first - tile.first * kTileCells);
}

CellIndex CellOf(double x_m, double y_m) {
  return {static_cast<std::int32_t>(std::floor(x_m / kHeightCell_m)),
          static_cast<std::int32_t>(std::floor(y_m / kHeightCell_m))};
}

TileIndex TileOf(const CellIndex& cell) {
  return {TileOfCell(cell.first), TileOfCell(cell.second)};
}

}  // namespace

void HeightGrid::Add(std::span<const SurfacePoint> points) {
  HeightTile* tile = nullptr;
  TileIndex tile_index;
  for (const SurfacePoint& point : points) {
    const Eigen::Vector3f& x = point.x_in_world;
    if (!x.allFinite() || x.cwiseAbs().maxCoeff() > kMaxCoordinate_m) continue;
    const CellIndex cell_index = CellOf(x.x(), x.y());
    const TileIndex index = TileOf(cell_index);
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
  const TileIndex index = TileOf(cell);
  const auto tile = tiles_.find(index);
  if (tile == tiles_.end()) return nullptr;
  const HeightCell& found = tile->second[IndexInTile(cell, index)];
  return found.points > 0 ? &found : nullptr;
}

TileIndex TileOf(const Eigen::Vector2d& x_in_world) {
  return TileOf(CellOf(x_in_world.x(), x_in_world.y()));
}

CellIndex CellOfTile(const TileIndex& tile, std::size_t index) {
  const auto i = static_cast<std::int32_t>(index);
  return {tile.first * kTileCells + i % kTileCells, tile.second * kTileCells + i / kTileCells};
}

Eigen::Vector2d CentreOf(const CellIndex& cell) {
  return {(cell.first + 0.5) * kHeightCell_m, (cell.second + 0.5) * kHeightCell_m};
}

}  // namespace rigmap
