// A voxel grid of any extent in bounded memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <span>

#include "fusion/internal/voxel_grid.h"
#include "geometry/tile_index.h"

namespace rigmap {

// The world is cut into upright columns of kTileVoxels x kTileVoxels cubes. Those used last stay in
// memory, the others lie in files until they are used again. What comes out does not depend on
// which. Not thread-safe.
class TiledGrid {
 public:
  static constexpr int kTileVoxels = 256;

  // Files go into `scratch`, which is made, and removed in the end. Up to `most_voxels` stay in
  // memory between two calls of SetAside, of about 80 bytes each.
  TiledGrid(double voxel_m, std::filesystem::path scratch, std::size_t most_voxels = 2'000'000);
  ~TiledGrid();
  TiledGrid(const TiledGrid&) = delete;
  TiledGrid& operator=(const TiledGrid&) = delete;

  // As VoxelGrid::Add. Throws DataError also when files cannot be written or read.
  void Add(const SurfaceSample& sample);
  // Writes tiles to files, those longest unused first, until no more than most_voxels are left.
  void SetAside();
  // The points of each tile (VoxelGrid::Points), ordered by tile (x, then y). Empties the grid.
  void Drain(int min_observations, double max_sigma_m,
             const std::function<void(std::span<const SurfacePoint>)>& take);

 private:
  struct Tile {
    std::optional<VoxelGrid> grid;  // nothing while it lies in a file
    std::uint64_t last_use = 0;
  };

  VoxelGrid& GridAt(const TileIndex& tile_index);
  std::filesystem::path FileOf(const TileIndex& tile_index) const;

  double voxel_m_;
  std::filesystem::path scratch_;
  std::size_t most_voxels_;
  std::map<TileIndex, Tile> tiles_;
  std::uint64_t time_ = 0;
  TileIndex last_tile_index_;
  VoxelGrid* last_grid_ = nullptr;
};

}  // namespace rigmap
