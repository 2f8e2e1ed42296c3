#include "fusion/internal/tiled_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <vector>

#include "core/error.h"

namespace rigmap {

TiledGrid::TiledGrid(double voxel_m, double tile_m, std::filesystem::path scratch,
                     std::size_t most_voxels)
    : voxel_m_(voxel_m), tile_m_(tile_m), scratch_(std::move(scratch)), most_voxels_(most_voxels) {
  std::error_code error;
  std::filesystem::remove_all(scratch_, error);
  if (!error) std::filesystem::create_directories(scratch_, error);
  if (error) {
    throw DataError(fmt::format("{}: expected to make a folder for voxels set aside, found: {}",
                                scratch_.string(), error.message()));
  }
}

TiledGrid::~TiledGrid() {
  std::error_code ignored;  // what is left over there takes room, no more
  std::filesystem::remove_all(scratch_, ignored);
}

std::filesystem::path TiledGrid::FileOf(const TileIndex& tile_index) const {
  return scratch_ / fmt::format("{}_{}", tile_index.first, tile_index.second);
}

VoxelGrid TiledGrid::EmptyGrid(const TileIndex& tile_index) const {
  return VoxelGrid(voxel_m_, tile_m_ * Eigen::Vector2d(static_cast<double>(tile_index.first),
                                                       static_cast<double>(tile_index.second)));
}

VoxelGrid& TiledGrid::GridAt(const TileIndex& tile_index) {
  if (last_grid_ && tile_index == last_tile_index_) return *last_grid_;
  const auto [entry, is_new] = tiles_.try_emplace(tile_index);
  Tile& tile = entry->second;
  if (!tile.grid) {
    tile.grid = EmptyGrid(tile_index);
    if (!is_new) tile.grid->Load(FileOf(tile_index));
  }
  tile.last_use = ++time_;
  last_tile_index_ = tile_index;
  last_grid_ = &*tile.grid;
  return *last_grid_;
}

void TiledGrid::Add(const SurfaceSample& sample) {
  // Points that are too far off, or nowhere (NaN), are refused by the grid itself.
  GridAt(TileAt(sample.x_in_world.head<2>(), tile_m_)).Add(sample);
}

void TiledGrid::SetAside() {
  std::vector<std::map<TileIndex, Tile>::iterator> in_memory;
  std::size_t voxels = 0;
  for (auto tile = tiles_.begin(); tile != tiles_.end(); ++tile) {
    if (!tile->second.grid) continue;
    in_memory.push_back(tile);
    voxels += tile->second.grid->VoxelCount();
  }
  std::sort(in_memory.begin(), in_memory.end(),
            [](const auto& a, const auto& b) { return a->second.last_use < b->second.last_use; });
  for (const auto& tile : in_memory) {
    if (voxels <= most_voxels_) return;
    voxels -= tile->second.grid->VoxelCount();
    tile->second.grid->Save(FileOf(tile->first));
    tile->second.grid.reset();
    last_grid_ = nullptr;
  }
}

std::vector<TileIndex> TiledGrid::Tiles() const {
  std::vector<TileIndex> indices;
  for (const auto& [tile_index, tile] : tiles_) indices.push_back(tile_index);
  return indices;
}

PointCloud TiledGrid::Take(const TileIndex& tile_index, int min_observations, double max_sigma_m) {
  const auto entry = tiles_.find(tile_index);
  if (entry == tiles_.end()) return {};
  last_grid_ = nullptr;
  Tile& tile = entry->second;
  if (!tile.grid) {
    tile.grid = EmptyGrid(tile_index);
    tile.grid->Load(FileOf(tile_index));
  }
  PointCloud points = tile.grid->Points(min_observations, max_sigma_m);
  tiles_.erase(entry);
  return points;
}

}  // namespace rigmap
