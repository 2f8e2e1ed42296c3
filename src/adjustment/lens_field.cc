#include "adjustment/internal/lens_field.h"

#include <algorithm>
#include <cmath>

namespace rigmap {
namespace {

constexpr double kCells = 10.0;  // along the longer side

std::size_t IndexOf(Eye eye) { return eye == Eye::kLeft ? 0 : 1; }

}  // namespace

LensField::LensField(const StereoRig& rig) {
  int parameters = 0;
  for (const Eye eye : kEyes) {
    const Camera& camera = rig.Of(eye).camera;
    const double cell = std::max(camera.width, camera.height) / kCells;
    Grid& grid = grids_[IndexOf(eye)];
    grid = {.columns = std::max(1, static_cast<int>(std::lround(camera.width / cell))),
            .rows = std::max(1, static_cast<int>(std::lround(camera.height / cell))),
            .width = static_cast<double>(camera.width),
            .height = static_cast<double>(camera.height),
            .first = parameters};
    parameters += 2 * (grid.columns + 1) * (grid.rows + 1);
  }
  values_ = Eigen::VectorXd::Zero(parameters);
}

LensField::Support LensField::At(Eye eye, const Eigen::Vector2d& pixel) const {
  const Grid& grid = grids_[IndexOf(eye)];
  const double x = std::clamp((pixel.x() + 0.5) / grid.width, 0.0, 1.0) * grid.columns,
               y = std::clamp((pixel.y() + 0.5) / grid.height, 0.0, 1.0) * grid.rows;
  const int column = std::min(static_cast<int>(x), grid.columns - 1),
            row = std::min(static_cast<int>(y), grid.rows - 1);
  const double right = x - column, below = y - row;
  const auto parameter = [&](int dx, int dy) {
    return grid.first + 2 * ((row + dy) * (grid.columns + 1) + column + dx);
  };
  return {
      {parameter(0, 0), parameter(1, 0), parameter(0, 1), parameter(1, 1)},
      {(1.0 - right) * (1.0 - below), right * (1.0 - below), (1.0 - right) * below, right * below}};
}

Eigen::Vector2d LensField::Displacement(Eye eye, const Eigen::Vector2d& pixel) const {
  return Follow(At(eye, pixel), values_);
}

double LensField::RmsPx() const {
  return std::sqrt(2.0 * values_.squaredNorm() / static_cast<double>(values_.size()));
}

}  // namespace rigmap
