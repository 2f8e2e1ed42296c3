#include "tests/evaluation/synthetic_beach.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace rigmap {
namespace {

constexpr double kSpacing_m = 0.01;

void Append(TrueSurface& surface, const Eigen::Vector3d& x, const Eigen::Vector3d& normal,
            std::uint8_t kind) {
  surface.x_in_truth.push_back(x.cast<float>());
  surface.normal.push_back(normal.cast<float>());
  surface.visible.push_back(1);
  surface.kind.push_back(kind);
}

// In rings of equal height.
void AppendDome(TrueSurface& surface, const Dome& dome) {
  const int rings = static_cast<int>(dome.radius_m * std::numbers::pi / 2.0 / kSpacing_m);
  for (int ring = 0; ring <= rings; ++ring) {
    const double elevation_rad = std::numbers::pi / 2.0 * ring / rings;
    const double ring_m = 2.0 * std::numbers::pi * dome.radius_m * std::cos(elevation_rad);
    const int count = std::max(1, static_cast<int>(ring_m / kSpacing_m));
    for (int i = 0; i < count; ++i) {
      const double azimuth_rad = 2.0 * std::numbers::pi * i / count;
      const Eigen::Vector3d normal(std::cos(elevation_rad) * std::cos(azimuth_rad),
                                   std::cos(elevation_rad) * std::sin(azimuth_rad),
                                   std::sin(elevation_rad));
      const Eigen::Vector3d centre(dome.centre.x(), dome.centre.y(), 0.0);
      Append(surface, centre + dome.radius_m * normal, normal, kRockKind);
    }
  }
}

}  // namespace

MapTruth MakeBeach(const std::vector<Dome>& domes) {
  MapTruth truth;
  for (int i = 0; i <= 10; ++i) {
    TumPose pose;
    pose.stamp_ns = 1'000'000'000LL * i;
    pose.world_from_body.translation = {0.2 * i, 0.0, 1.0};
    truth.path.push_back(pose);
  }
  for (int i = 50; i <= 170; ++i) {
    for (int j = -400; j <= 400; ++j) {
      const Eigen::Vector2d xy(kSpacing_m * i, kSpacing_m * j);
      const auto covers = [&](const Dome& dome) {
        return (xy - dome.centre).norm() < dome.radius_m;
      };
      if (std::any_of(domes.begin(), domes.end(), covers)) continue;
      Append(truth.surface, {xy.x(), xy.y(), 0.0}, Eigen::Vector3d::UnitZ(), 0);
    }
  }
  for (const Dome& dome : domes) {
    AppendDome(truth.surface, dome);
    truth.rocks.push_back({"small", {dome.centre.x(), dome.centre.y(), 0.0}, 2.2 * dome.radius_m});
  }
  return truth;
}

Points Displaced(Points points, const Eigen::Vector3f& by) {
  for (auto& x : points) x += by;
  return points;
}

Points PointsOfKind(const MapTruth& truth, bool rock) {
  Points points;
  for (std::size_t i = 0; i < truth.surface.size(); ++i) {
    const bool is_rock = truth.surface.kind[i] == kRockKind;
    if (is_rock == rock) points.push_back(truth.surface.x_in_truth[i]);
  }
  return points;
}

Points Together(Points points, const Points& more) {
  points.insert(points.end(), more.begin(), more.end());
  return points;
}

RockMetrics OnlyRock(const Points& map, const MapTruth& truth) {
  const auto rocks = CompareRocks(AlreadyAligned(map, truth));
  if (rocks.size() != 1) throw std::runtime_error("expected one rock");
  return rocks.front();
}

}  // namespace rigmap
