#include "raster/internal/point_cells.h"

#include <algorithm>
#include <cmath>

#include "geometry/tile_index.h"

namespace rigmap {

PointCells::PointCells(const CellFrame& frame, const std::optional<GridFrame>& grid)
    : frame_(frame), grid_(grid) {
  if (grid) world_from_grid_ = grid->grid_from_world.inverse();
}

Eigen::Vector2d PointCells::InWorld(int column, int row) const {
  return world_from_grid_ *
         (frame_.UpperLeft() + frame_.cell_m * Eigen::Vector2d(column + 0.5, -row - 0.5));
}

void PointCells::ForEach(const SurfacePoint& point,
                         const std::function<void(int column, int row)>& take) const {
  const double cell_m = frame_.cell_m;
  const int side = std::clamp(static_cast<int>(std::lround(point.grain_m / cell_m)), 1,
                              static_cast<int>(kMostCells));
  // Columns of the world to the east, rows to the north.
  const std::int64_t west = side * TileAlong(point.x_in_world.x(), side * cell_m);
  const std::int64_t south = side * TileAlong(point.x_in_world.y(), side * cell_m);
  const Eigen::Vector2d low =
      cell_m * Eigen::Vector2d(static_cast<double>(west), static_cast<double>(south));
  Eigen::AlignedBox2d box(low, low + Eigen::Vector2d::Constant(cell_m * side));
  if (grid_) {
    const Eigen::AlignedBox2d cube = box;
    box.setEmpty();
    for (int i = 0; i < 4; ++i) {
      box.extend(grid_->grid_from_world *
                 cube.corner(static_cast<Eigen::AlignedBox2d::CornerType>(i)));
    }
  }
  // By half a cell inwards: what begins beyond the middle of a cell does not hold it.
  const double half_m = 0.5 * cell_m;
  const int first_column = std::max(frame_.Column(box.min().x() + half_m), 0);
  const int last_column = std::min(frame_.Column(box.max().x() - half_m), frame_.columns - 1);
  const int first_row = std::max(frame_.Row(box.max().y() - half_m), 0);
  const int last_row = std::min(frame_.Row(box.min().y() + half_m), frame_.rows - 1);
  for (int row = first_row; row <= last_row; ++row) {
    for (int column = first_column; column <= last_column; ++column) {
      if (grid_) {
        const Eigen::Vector2d middle = InWorld(column, row);
        const std::int64_t c = TileAlong(middle.x(), cell_m) - west;
        const std::int64_t r = TileAlong(middle.y(), cell_m) - south;
        if (c < 0 || c >= side || r < 0 || r >= side) continue;
      }
      take(column, row);
    }
  }
}

}  // namespace rigmap
