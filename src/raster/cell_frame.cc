#include "raster/cell_frame.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "core/error.h"
#include "export/ply_reader.h"
#include "geometry/tile_index.h"

namespace rigmap {
namespace {

constexpr double kMaxCells = 2e9;      // empty ones take time as well: a minute and a half per 1e9
constexpr double kMaxSideCells = 1e9;  // so that cells can be counted in an int

void ForEachFinite(const std::filesystem::path& ply,
                   const std::function<void(const SurfacePoint&)>& take) {
  PlyReader reader(ply);
  PointCloud block;
  while (reader.Read(block)) {
    for (const SurfacePoint& point : block) {
      if (point.x_in_world.allFinite()) take(point);
    }
  }
}

// The size of the finest points where all are coarser than a cell, else that of a cell: usually
// known from the first block.
double FinestGrain(const GriddedCloud& cloud) {
  double finest_m = std::numeric_limits<double>::infinity();
  PlyReader reader(cloud.ply);
  PointCloud block;
  while (finest_m > cloud.cell_m && reader.Read(block)) {
    for (const SurfacePoint& point : block) {
      if (point.x_in_world.allFinite()) finest_m = std::min<double>(finest_m, point.grain_m);
    }
  }
  return std::max(finest_m, cloud.cell_m);
}

}  // namespace

int CellFrame::Column(double x_m) const { return static_cast<int>(TileAlong(x_m, cell_m) - west); }

int CellFrame::Row(double y_m) const { return static_cast<int>(north - TileAlong(y_m, cell_m)); }

Eigen::Vector2d CellFrame::UpperLeft() const {
  return cell_m * Eigen::Vector2d(static_cast<double>(west), static_cast<double>(north + 1));
}

void GriddedCloud::Validate() const {
  if (!(cell_m >= 1e-4 && cell_m <= 1000.0)) {
    throw UsageError(fmt::format("cells: expected 0.0001 to 1000 m, found {}", cell_m));
  }
}

void ForEachShown(const GriddedCloud& cloud, const std::function<void(const SurfacePoint&)>& take) {
  const double most_m = kMostCells * FinestGrain(cloud);
  ForEachFinite(cloud.ply, [&](const SurfacePoint& point) {
    if (!point.IsCoarserThan(most_m)) take(point);
  });
}

CellFrame FrameOf(const GriddedCloud& cloud, const std::optional<GridFrame>& grid) {
  const std::filesystem::path& ply = cloud.ply;
  Eigen::AlignedBox2d bounds;
  ForEachShown(cloud, [&](const SurfacePoint& point) {
    const Eigen::Vector2d x_in_world = point.x_in_world.head<2>().cast<double>();
    bounds.extend(grid ? grid->grid_from_world * x_in_world : x_in_world);
  });
  if (bounds.isEmpty()) {
    throw DataError(fmt::format("{}: expected points, found none", ply.string()));
  }
  for (double cell_m = cloud.cell_m;; cell_m *= 2.0) {
    const Eigen::Array2d low = (bounds.min().array() / cell_m).floor();
    const Eigen::Array2d high = (bounds.max().array() / cell_m).floor();
    const Eigen::Array2d cells = high - low + 1.0;
    const double farthest = std::max(low.abs().maxCoeff(), high.abs().maxCoeff());
    if (cells.prod() > kMaxCells || cells.maxCoeff() > kMaxSideCells || farthest > 1e15) continue;
    if (cell_m > cloud.cell_m) {
      spdlog::warn("{}: {:g} m x {:g} m: more than {:g} cells of {} m, {:g} m are taken",
                   ply.string(), bounds.sizes().x(), bounds.sizes().y(), kMaxCells, cloud.cell_m,
                   cell_m);
    }
    return {cell_m, static_cast<std::int64_t>(low.x()), static_cast<std::int64_t>(high.y()),
            static_cast<int>(cells.x()), static_cast<int>(cells.y())};
  }
}

}  // namespace rigmap
