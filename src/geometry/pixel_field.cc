#include "geometry/pixel_field.h"

#include <algorithm>

namespace rigmap {

NodeGrid::Support NodeGrid::At(const Eigen::Vector2d& pixel) const {
  const double x = std::clamp((pixel.x() + 0.5) / width, 0.0, 1.0) * columns,
               y = std::clamp((pixel.y() + 0.5) / height, 0.0, 1.0) * rows;
  const int column = std::min(static_cast<int>(x), columns - 1),
            row = std::min(static_cast<int>(y), rows - 1);
  const double right = x - column, below = y - row;
  const int first = row * (columns + 1) + column, next = first + columns + 1;
  return {
      {first, first + 1, next, next + 1},
      {(1.0 - right) * (1.0 - below), right * (1.0 - below), (1.0 - right) * below, right * below}};
}

Eigen::Vector2d PixelField::At(const Eigen::Vector2d& pixel) const {
  const NodeGrid::Support support = grid.At(pixel);
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (int i = 0; i < 4; ++i) sum += support.weight[i] * displacements[support.node[i]];
  return sum;
}

}  // namespace rigmap
