// A voxel grid of any extent in bounded memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <vector>

#include "fusion/internal/voxel_grid.h"
#include "geometry/tile_index.h"

namespace rigmap {

// The world is cut into upright columns, tile_m wide. Those used last stay in
// memory, the others lie in files until they are used again. What comes out does not depend on
// which. Not thread-safe.
class TiledGrid {
 public:
  // Files go into `scratch`, which is made, and removed in the end. Up to `most_voxels` stay in
  // memory between two calls of SetAside, of about 80 bytes each.
  TiledGrid(double voxel_m, double tile_m, std::filesystem::path scratch, std::size_t most_voxels);
  ~TiledGrid();
  TiledGrid(const TiledGrid&) = delete;
  TiledGrid& operator=(const TiledGrid&) = delete;

  // As VoxelGrid::Add. Throws DataError also when files cannot be written or read.
  void Add(const SurfaceSample& sample);
  // Writes tiles to files, those longest unused first, until no more than most_voxels are left.
  void SetAside();
  // Those that something was added to, ordered by x, then y.
  std::vector<TileIndex> Tiles() const;
  // The points of a tile (VoxelGrid::Points), none where there is no such tile. Empties it.
  PointCloud Take(const TileIndex& tile_index, int min_observations, double max_sigma_m);

 private:
  struct Tile {
    std::optional<VoxelGrid> grid;  // nothing while it lies in a file
    std::uint64_t last_use = 0;
  };

  VoxelGrid EmptyGrid(const TileIndex& tile_index) const;
  VoxelGrid& GridAt(const TileIndex& tile_index);
  std::filesystem::path FileOf(const TileIndex& tile_index) const;

  double voxel_m_, tile_m_;
  std::filesystem::path scratch_;
  std::size_t most_voxels_;
  std::map<TileIndex, Tile> tiles_;
  std::uint64_t time_ = 0;
  TileIndex last_tile_index_;
  VoxelGrid* last_grid_ = nullptr;
};

}  // namespace rigmap
