#include "raster/internal/surface_patch.h"

#include <algorithm>
#include <cmath>

namespace rigmap {
namespace {

constexpr double kDoubtSigmas = 2.0;
constexpr float kSteep = 0.7071F;  // cosine of 45 degrees

std::array<std::int8_t, 3> Packed(const Eigen::Vector3f& normal) {
  std::array<std::int8_t, 3> packed{};
  if (!normal.allFinite()) return packed;
  for (int i = 0; i < 3; ++i) {
    packed[i] = static_cast<std::int8_t>(std::lround(127.0F * std::clamp(normal(i), -1.0F, 1.0F)));
  }
  return packed;
}

}  // namespace

SurfacePatch PatchOf(const SurfacePoint& point) {
  const Eigen::Vector3d x = point.x_in_world.cast<double>(), normal = point.normal.cast<double>();
  const double side_m = point.grain_m;
  int axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  SurfacePatch patch;
  patch.corner = side_m * (x / side_m).array().floor();
  patch.corner(axis) = x(axis);
  for (int i = 0; i < 2; ++i) {
    const int along = (axis + 1 + i) % 3;
    const double slope = -normal(along) / normal(axis);
    patch.corner(axis) += slope * (patch.corner(along) - x(along));
    patch.edges[i].setZero();
    patch.edges[i](along) = side_m;
    patch.edges[i](axis) = slope * side_m;
  }
  return patch;
}

double HeightAt(const SurfacePoint& point, const Eigen::Vector2d& x_in_world) {
  const Eigen::Vector3d normal = point.normal.cast<double>();
  if (!(normal.z() >= kSteep)) return point.x_in_world.z();
  const Eigen::Vector2d off_m = x_in_world - point.x_in_world.head<2>().cast<double>();
  const double rise_m = -normal.head<2>().dot(off_m) / normal.z();
  return point.x_in_world.z() + std::clamp<double>(rise_m, -point.grain_m, point.grain_m);
}

CellSample SampleOf(const SurfacePoint& point, double height_m, double cell_m) {
  CellSample sample{.height_m = static_cast<float>(height_m),
                    .rgb = point.rgb,
                    .weight = std::max<float>(1.0F, point.observations),
                    .observations = static_cast<float>(point.observations),
                    .sigma_m = point.sigma_m,
                    .normal = Packed(point.normal)};
  if (point.IsCoarserThan(cell_m)) {
    const double cells = point.grain_m / cell_m;
    sample.weight /= static_cast<float>(cells * cells);
    sample.doubt_m = static_cast<float>(kDoubtSigmas * point.sigma_m);
  }
  return sample;
}

}  // namespace rigmap
