#include "simulation/boulders.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "simulation/internal/noise.h"

namespace rigmap {
namespace {

struct Size {
  const char* name;
  double height_m, width_m;
  double share;  // of all boulders, added up
};
constexpr std::array<Size, 3> kSizes{
    {{"small", 0.30, 0.44, 0.5}, {"medium", 0.55, 0.80, 0.8}, {"large", 0.80, 1.10, 1.0}}};
constexpr double kReach_m = 7.0, kClearance_m = 0.95;

// A sphere cut flat on many sides, its edges rounded and its faces roughened, of width 1 and height
// 1 above its foot; a fifth of it lies below.
Mesh RawShape(HashSequence& random) {
  constexpr int kCuts = 14, kSubdivisions = 5;
  constexpr double kSharpness = 18.0;
  std::array<Eigen::Vector3d, kCuts> cuts;
  for (auto& cut : cuts) {
    const double angle = random.Between(0.0, 2.0 * std::numbers::pi),
                 up = random.Between(-0.2, 1.0);
    const double flat = std::sqrt(1.0 - up * up);
    cut = Eigen::Vector3d(flat * std::cos(angle), flat * std::sin(angle), up) /
          random.Between(0.62, 0.95);
  }
  const std::uint32_t seed = random.Next();
  Mesh mesh = Icosphere(kSubdivisions);
  for (auto& vertex : mesh.vertices) {
    const Eigen::Vector3d direction = vertex.cast<double>();
    double sum = 1.0;  // the sphere itself
    for (const auto& cut : cuts) sum += std::pow(std::max(0.0, direction.dot(cut)), kSharpness);
    const Eigen::Vector3d position = direction * std::pow(sum, -1.0 / kSharpness);
    const Eigen::Vector3d at = 3.1 * position;
    const double rough =
        0.055 * GradientNoise3(at.x(), at.y(), at.z(), seed) +
        0.028 * GradientNoise3(2.7 * at.x(), 2.7 * at.y(), 2.7 * at.z(), seed + 1) +
        0.012 * GradientNoise3(7.0 * at.x(), 7.0 * at.y(), 7.0 * at.z(), seed + 2);
    vertex = ((1.0 + rough) * position).cast<float>();
  }
  return mesh;
}

// The raw shape brought to its size and place.
Boulder Settle(const Size& size, const Eigen::Vector3d& centre, HashSequence& random) {
  Boulder boulder{.size = size.name,
                  .height_m = size.height_m,
                  .width_m = size.width_m,
                  .yaw_rad = random.Between(0.0, 2.0 * std::numbers::pi),
                  .centre = centre,
                  .top = centre,
                  .mesh = RawShape(random)};
  boulder.mesh.albedo = Eigen::Vector3f(0.235f, 0.215f, 0.195f);
  float widest = 0.0f, highest = 0.0f;
  for (const auto& vertex : boulder.mesh.vertices) {
    widest = std::max(widest, vertex.head<2>().norm());
    highest = std::max(highest, vertex.z());
  }
  const Eigen::Rotation2Df turn(static_cast<float>(boulder.yaw_rad));
  for (auto& vertex : boulder.mesh.vertices) {
    const Eigen::Vector2f flat =
        turn * vertex.head<2>() * (0.5f * static_cast<float>(size.width_m) / widest);
    const double up = vertex.z() / highest * size.height_m;
    const Eigen::Vector3d position = centre + Eigen::Vector3d(flat.x(), flat.y(), up);
    if (position.z() > boulder.top.z()) boulder.top = position;
    vertex = position.cast<float>();
  }
  return boulder;
}

const Size& DrawSize(HashSequence& random) {
  const double share = random.Unit();
  return *std::find_if(kSizes.begin(), kSizes.end() - 1,
                       [&](const Size& size) { return share < size.share; });
}

}  // namespace

std::vector<Boulder> ScatterBoulders(const Terrain& terrain,
                                     std::span<const Eigen::Vector2d> outline, double per_100_m2,
                                     std::uint64_t seed) {
  std::vector<Boulder> boulders;
  if (outline.empty()) return boulders;
  double length_m = 0.0;
  for (std::size_t i = 1; i < outline.size(); ++i) {
    length_m += (outline[i] - outline[i - 1]).norm();
  }
  const double area_m2 = kReach_m * (2.0 * length_m + std::numbers::pi * kReach_m);
  const int wanted = static_cast<int>(std::lround(per_100_m2 * area_m2 / 100.0));
  HashSequence random(seed, 21);
  for (int tries = 0; static_cast<int>(boulders.size()) < wanted && tries < 40 * wanted; ++tries) {
    const auto at = static_cast<std::size_t>(random.Unit() * static_cast<double>(outline.size()));
    const double angle = random.Between(0.0, 2.0 * std::numbers::pi);
    const double away_m = kReach_m * std::sqrt(random.Unit());
    const Eigen::Vector2d position =
        outline[at] + away_m * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    const Size& size = DrawSize(random);
    const bool is_free =
        std::ranges::all_of(outline,
                            [&](const Eigen::Vector2d& way) {
                              return (way - position).norm() > 0.5 * size.width_m + kClearance_m;
                            }) &&
        std::ranges::all_of(boulders, [&](const Boulder& other) {
          return (other.centre.head<2>() - position).norm() >
                 0.5 * (size.width_m + other.width_m) + 0.1;
        });
    if (!is_free) continue;
    const Eigen::Vector3d centre(position.x(), position.y(),
                                 terrain.Height(position.x(), position.y()));
    boulders.push_back(Settle(size, centre, random));
  }
  return boulders;
}

}  // namespace rigmap
