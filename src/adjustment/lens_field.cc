#include "adjustment/internal/lens_field.h"

#include <algorithm>
#include <cmath>

namespace rigmap {
namespace {

constexpr double kCells = 10.0;  // along the longer side

}  // namespace

LensField::LensField(const StereoRig& rig) {
  int parameters = 0;
  for (std::size_t i = 0; i < grids_.size(); ++i) {
    const Camera& camera = rig.Of(kEyes[i]).camera;
    const double cell = std::max(camera.width, camera.height) / kCells;
    EyeGrid& grid = grids_[i];
    grid.columns = std::max(1, static_cast<int>(std::lround(camera.width / cell)));
    grid.rows = std::max(1, static_cast<int>(std::lround(camera.height / cell)));
    grid.width = static_cast<double>(camera.width);
    grid.height = static_cast<double>(camera.height);
    grid.first = parameters;
    parameters += 2 * grid.Nodes();
  }
  values_ = Eigen::VectorXd::Zero(parameters);
}

LensField::Support LensField::At(Eye eye, const Eigen::Vector2d& pixel) const {
  const EyeGrid& grid = GridOf(eye);
  const NodeGrid::Support nodes = grid.At(pixel);
  Support support{{}, nodes.weight};
  for (int i = 0; i < 4; ++i) support.parameter[i] = grid.first + 2 * nodes.node[i];
  return support;
}

Eigen::Vector2d LensField::Displacement(Eye eye, const Eigen::Vector2d& pixel) const {
  return Follow(At(eye, pixel), values_);
}

double LensField::RmsPx() const {
  return std::sqrt(2.0 * values_.squaredNorm() / static_cast<double>(values_.size()));
}

PixelField LensField::Of(Eye eye) const {
  const EyeGrid& grid = GridOf(eye);
  PixelField field{grid, {}};
  for (int node = 0; node < grid.Nodes(); ++node) {
    field.displacements.emplace_back(values_.segment<2>(grid.first + 2 * node));
  }
  return field;
}

}  // namespace rigmap
