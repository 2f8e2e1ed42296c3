// Voxels as large as what is known of the points in them.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <span>

#include "fusion/fusion_options.h"
#include "fusion/internal/tiled_grid.h"

namespace rigmap {

// The finest layer has cubes of `voxel_m` for level ground, and finer ones for what is steeper than
// 45 degrees. Points go into a layer whose cubes are two to the n times as large, no smaller than
// the point's sigma, nor than what a pixel covers, if they are not known to kFineSigmas of the
// finest cubes along the ray, or off the surface to kFineOff of those that they would lie in, or if
// a pixel covers kFinePixels of them. Far level ground is seen edge on and known well off its
// surface; far faces are seen head on. Coarse points where finer ones are seen are left out: those
// in a cube in which a finer layer has a point, or above or below of which it has one, and of what
// is steep also beside; level ground goes on where the finer layer ends. Not thread-safe.
class LayeredGrid {
 public:
  static constexpr double kFineSigmas = 3.0;
  static constexpr double kFinePixels = 2.0;
  static constexpr double kFineOff = 1.5;
  static constexpr int kLayers = 8;

  // Files go into `scratch`, which is made, and removed in the end. Up to `most_voxels` stay in
  // memory between two calls of Add.
  LayeredGrid(double voxel_m, double steep_voxel_share, std::filesystem::path scratch,
              std::size_t most_voxels);
  ~LayeredGrid();
  LayeredGrid(const LayeredGrid&) = delete;
  LayeredGrid& operator=(const LayeredGrid&) = delete;

  // As VoxelGrid::Add. Throws DataError also when files cannot be written or read.
  void Add(std::span<const SurfaceSample> samples);

  // The points with as many observations as the options ask for, by tile and layer. Empties the
  // grid.
  void Drain(const FusionOptions& options,
             const std::function<void(std::span<const SurfacePoint>)>& take);

  // The layer for a sample.
  int LayerOf(const SurfaceSample& sample) const;

 private:
  class Cover;

  static bool IsSteep(const SurfaceSample& sample);

  TiledGrid& Layer(int layer);
  PointCloud Take(int layer, const TileIndex& tile, const FusionOptions& options);

  double voxel_m_, steep_voxel_share_;
  std::filesystem::path scratch_;
  std::size_t most_voxels_;
  TiledGrid steep_;
  std::map<int, TiledGrid> layers_;  // the finest is layer 0
};

}  // namespace rigmap
