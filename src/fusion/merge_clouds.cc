#include "fusion/merge_clouds.h"

#include <limits>

#include "core/progress.h"
#include "fusion/internal/tiled_grid.h"

namespace rigmap {

void MergeClouds(std::size_t count, const std::function<PointCloud(std::size_t)>& cloud_of,
                 double grid_m, const FusionTarget& target) {
  constexpr double kTileCubes = 512.0;
  TiledGrid grid(grid_m, kTileCubes * grid_m, target.scratch, kKeptVoxels);
  Progress progress("merging", count);
  for (std::size_t i = 0; i < count; ++i) {
    for (const SurfacePoint& point : cloud_of(i)) {
      grid.Add({.x_in_world = point.x_in_world.cast<double>(),
                .normal = point.normal,
                .rgb = point.rgb,
                .sigma_m = point.sigma_m,
                .observations = point.observations,
                .pixel_m = static_cast<float>(grid_m)});
    }
    grid.SetAside();
    progress.Advance();
  }
  for (const TileIndex& tile : grid.Tiles()) {
    PointCloud points = grid.Take(tile, 1, std::numeric_limits<double>::infinity());
    for (SurfacePoint& point : points) point.grain_m = static_cast<float>(grid_m);
    target.take(points);
  }
}

}  // namespace rigmap
