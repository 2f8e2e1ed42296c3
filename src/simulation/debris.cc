#include "simulation/internal/debris.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulation/internal/noise.h"

namespace rigmap {
namespace {

struct DebrisAppearance {
  Eigen::Vector3f half_extent_m;  // along, across, up
  Eigen::Vector3f albedo;
};

DebrisAppearance DrawAppearance(HashSequence& random) {
  const auto between = [&](double low, double high) {
    return static_cast<float>(random.Between(low, high));
  };
  const double kind = random.Unit();
  if (kind < 0.25) {  // driftwood, seaweed
    const float length = between(0.02, 0.054);
    return {{length, between(0.004, 0.010), between(0.004, 0.010)},
            Eigen::Vector3f(0.11f, 0.075f, 0.05f) * between(0.6, 1.3)};
  }
  const float width = between(0.005, 0.016);
  const Eigen::Vector3f extent(width * between(1.0, 1.5), width, width * between(0.45, 0.8));
  if (kind < 0.45) return {extent, Eigen::Vector3f(0.75f, 0.72f, 0.68f) * between(0.8, 1.15)};
  if (kind < 0.7) return {extent, Eigen::Vector3f(0.09f, 0.09f, 0.10f) * between(0.6, 1.4)};
  return {extent, Eigen::Vector3f(0.30f, 0.26f, 0.21f) * between(0.7, 1.3)};
}

Mesh Shape(const DebrisAppearance& appearance, const Eigen::Vector3d& position,
           HashSequence& random) {
  Mesh mesh = Icosphere(1);
  mesh.albedo = appearance.albedo;
  const Eigen::Matrix3f turn =
      (Eigen::AngleAxisd(random.Between(0.0, 2.0 * std::numbers::pi), Eigen::Vector3d::UnitZ()) *
       Eigen::AngleAxisd(random.Between(-0.25, 0.25), Eigen::Vector3d::UnitX()) *
       Eigen::AngleAxisd(random.Between(-0.1, 0.1), Eigen::Vector3d::UnitY()))
          .toRotationMatrix()
          .cast<float>();
  for (auto& vertex : mesh.vertices) {
    const auto dent = static_cast<float>(random.Between(0.85, 1.1));
    vertex = turn * (dent * vertex.cwiseProduct(appearance.half_extent_m)) + position.cast<float>();
  }
  return mesh;
}

}  // namespace

std::vector<Mesh> StrewDebris(const Terrain& terrain, std::span<const Eigen::Vector2d> outline,
                              double reach_m, double per_m2, std::uint64_t seed) {
  std::vector<Mesh> debris;
  if (outline.empty()) return debris;
  Eigen::Array2d low = outline[0], high = outline[0];
  for (const auto& way : outline) {
    low = low.min(way.array());
    high = high.max(way.array());
  }
  low -= reach_m;
  high += reach_m;
  HashSequence random(seed, 31);
  const auto count = static_cast<int>(per_m2 * (high - low).prod());
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector2d position(random.Between(low.x(), high.x()),
                                   random.Between(low.y(), high.y()));
    const DebrisAppearance appearance = DrawAppearance(random);
    const bool is_near = std::ranges::any_of(outline, [&](const Eigen::Vector2d& way) {
      return (way - position).squaredNorm() < reach_m * reach_m;
    });
    if (!is_near) continue;
    debris.push_back(Shape(appearance,
                           {position.x(), position.y(), terrain.Height(position.x(), position.y())},
                           random));
  }
  return debris;
}

}  // namespace rigmap
