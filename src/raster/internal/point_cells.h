// Which cells of a map a point stands for.
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <optional>

#include "georeference/earth_frame.h"
#include "raster/cell_frame.h"
#include "scene/point_cloud.h"

namespace rigmap {

// In a map of the world: the cells of the cube that the point lies in. In a map of the Earth: the
// cells whose middle, taken back to the world, lies in one of these, so that each cell of the map
// takes what the nearest of the world's holds, and turning the map opens no holes.
class PointCells {
 public:
  PointCells(const CellFrame& frame, const std::optional<GridFrame>& grid);

  // Those inside the frame.
  void ForEach(const SurfacePoint& point,
               const std::function<void(int column, int row)>& take) const;

  // World's x and y of the middle of a cell, also outside the frame.
  Eigen::Vector2d InWorld(int column, int row) const;

  const CellFrame& frame() const { return frame_; }

 private:
  CellFrame frame_;
  std::optional<GridFrame> grid_;
  Eigen::Affine2d world_from_grid_ = Eigen::Affine2d::Identity();
};

}  // namespace rigmap
