#include "evaluation/rock_metrics.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>

#include "core/statistics.h"

namespace rigmap {
namespace {

constexpr double kMaxFromPath_m = 3.5;           // as far as maps are judged
constexpr std::size_t kMinVisiblePoints = 1000;  // a third of a small rock
constexpr double kComplete_m = 0.02;             // two grains of the surface
constexpr double kMatch_m = 0.06;                // farther points may be another surface
constexpr std::size_t kMinMatches = 100;         // fewer say nothing about the shape
constexpr double kTop_m = 0.1;                   // points that may belong to the rock itself
constexpr double kAround_m = 0.3;                // where a second copy would stand
constexpr double kOverSand_m = 0.05;             // so that the sand around is left out
constexpr double kGhost_m = 0.04;                // farther from all that exists
constexpr double kTopShare = 0.995;              // leaves out a few flying points
// Map points are looked for around every 20th point of the rock, 3 cm farther than they are used.
constexpr std::size_t kSampleStep = 20;
constexpr double kSampleReach_m = 0.33;

// A rock's visible surface.
struct RockSurface {
  std::vector<Eigen::Vector3f> x, normal;

  Eigen::Vector3d Centre() const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const auto& point : x) sum += point.cast<double>();
    return sum / static_cast<double>(x.size());
  }
  double Top() const {
    return std::max_element(x.begin(), x.end(),
                            [](const auto& a, const auto& b) { return a.z() < b.z(); })
        ->z();
  }
};

// A map point and the rock's point next to it.
struct MapPointAtRock {
  Eigen::Vector3d x;
  Neighbour nearest;
};

double FromCentre(const TrueRock& rock, const Eigen::Vector2d& xy) {
  return (xy - rock.x_in_truth.head<2>()).norm();
}

std::size_t NearestRock(const std::vector<TrueRock>& rocks, const Eigen::Vector2d& xy) {
  const auto nearest = std::min_element(
      rocks.begin(), rocks.end(),
      [&](const auto& a, const auto& b) { return FromCentre(a, xy) < FromCentre(b, xy); });
  return static_cast<std::size_t>(nearest - rocks.begin());
}

RockSurface SurfaceOf(std::size_t index, const MapTruth& truth) {
  const TrueRock& rock = truth.rocks[index];
  const TrueSurface& surface = truth.surface;
  RockSurface found;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (surface.kind[i] != kRockKind || !surface.visible[i]) continue;
    const Eigen::Vector2d xy = surface.x_in_truth[i].head<2>().cast<double>();
    if (!(FromCentre(rock, xy) < rock.width_m) || NearestRock(truth.rocks, xy) != index) continue;
    found.x.push_back(surface.x_in_truth[i]);
    found.normal.push_back(surface.normal[i]);
  }
  return found;
}

// The map's points within kAround_m of the rock.
std::vector<MapPointAtRock> MapPointsAt(const RockSurface& surface, const MapOverTruth& map) {
  std::vector<Eigen::Vector3f> samples;
  for (std::size_t i = 0; i < surface.x.size(); i += kSampleStep) samples.push_back(surface.x[i]);
  const Eigen::Vector3d centre = surface.Centre();
  double radius_m = 0.0;
  for (const auto& x : samples) radius_m = std::max(radius_m, (x.cast<double>() - centre).norm());
  const PointTree<Eigen::Vector3f> sample_tree(samples), tree(surface.x);
  std::vector<MapPointAtRock> points;
  for (const auto i : map.MapPointsWithin(centre, radius_m + kSampleReach_m)) {
    const Eigen::Vector3d x = map.MapPoint(i);
    if (!sample_tree.Nearest(x, kSampleReach_m)) continue;
    const auto nearest = tree.Nearest(x, kAround_m);
    if (nearest) points.push_back({x, *nearest});
  }
  return points;
}

double Completeness(const RockSurface& surface, const MapOverTruth& map) {
  const auto mapped = std::count_if(surface.x.begin(), surface.x.end(), [&](const auto& x) {
    return map.NearestOfMap(x.template cast<double>(), kComplete_m).has_value();
  });
  return static_cast<double>(mapped) / static_cast<double>(surface.x.size());
}

// In rows: the view of the rock from the true pose nearest to it, to its left, up.
Eigen::Matrix3d ViewAxes(const TrueRock& rock, const std::vector<TumPose>& path) {
  const auto xy = [](const TumPose& pose) { return pose.world_from_body.translation.head<2>(); };
  const auto nearest =
      std::min_element(path.begin(), path.end(), [&](const auto& a, const auto& b) {
        return FromCentre(rock, xy(a)) < FromCentre(rock, xy(b));
      });
  const Eigen::Vector2d view = (rock.x_in_truth.head<2>() - xy(*nearest)).normalized();
  Eigen::Matrix3d axes;
  axes << view.x(), view.y(), 0.0, -view.y(), view.x(), 0.0, 0.0, 0.0, 1.0;
  return axes;
}

std::optional<RockDeformation> DeformationOf(const RockSurface& surface,
                                             const std::vector<MapPointAtRock>& points,
                                             const Eigen::Matrix3d& axes) {
  std::vector<RockMatch> matches;
  for (const auto& [x, nearest] : points) {
    if (!(nearest.distance < kMatch_m)) continue;
    matches.push_back(
        {surface.x[nearest.index].cast<double>(), surface.normal[nearest.index].cast<double>(), x});
  }
  if (matches.size() < kMinMatches) return std::nullopt;
  return FitDeformation(matches, surface.Centre(), axes);
}

std::optional<double> GhostShare(const std::vector<MapPointAtRock>& points, double sand_z_m,
                                 const MapOverTruth& map) {
  std::size_t over_sand = 0, ghosts = 0;
  for (const auto& point : points) {
    if (!(point.x.z() > sand_z_m + kOverSand_m)) continue;
    ++over_sand;
    if (!map.NearestOfSurface(point.x, kGhost_m)) ++ghosts;
  }
  if (over_sand == 0) return std::nullopt;
  return static_cast<double>(ghosts) / static_cast<double>(over_sand);
}

std::optional<double> TopOverTruth(const RockSurface& surface,
                                   const std::vector<MapPointAtRock>& points) {
  std::vector<double> heights_m;
  for (const auto& point : points) {
    if (point.nearest.distance < kTop_m) heights_m.push_back(point.x.z());
  }
  if (heights_m.empty()) return std::nullopt;
  return InterpolatedQuantile(heights_m, kTopShare) - surface.Top();
}

bool IsNearPath(const TrueRock& rock, const std::vector<TumPose>& path) {
  return std::any_of(path.begin(), path.end(), [&](const TumPose& pose) {
    return FromCentre(rock, pose.world_from_body.translation.head<2>()) <= kMaxFromPath_m;
  });
}

std::optional<RockMetrics> JudgeRock(std::size_t index, const MapOverTruth& map) {
  const TrueRock& rock = map.truth().rocks[index];
  if (!IsNearPath(rock, map.truth().path)) return std::nullopt;
  const RockSurface surface = SurfaceOf(index, map.truth());
  if (surface.x.size() < kMinVisiblePoints) return std::nullopt;
  const auto points = MapPointsAt(surface, map);
  RockMetrics metrics{.rock = rock, .visible_points = surface.x.size()};
  metrics.completeness = Completeness(surface, map);
  metrics.deformation = DeformationOf(surface, points, ViewAxes(rock, map.truth().path));
  metrics.ghost_share = GhostShare(points, rock.x_in_truth.z(), map);
  if (metrics.ghost_share) metrics.top_m = TopOverTruth(surface, points);
  return metrics;
}

}  // namespace

std::vector<RockMetrics> CompareRocks(const MapOverTruth& map) {
  std::vector<std::optional<RockMetrics>> judged(map.truth().rocks.size());
  tbb::parallel_for(std::size_t{0}, judged.size(),
                    [&](std::size_t i) { judged[i] = JudgeRock(i, map); });
  std::vector<RockMetrics> rocks;
  for (auto& rock : judged) {
    if (rock) rocks.push_back(std::move(*rock));
  }
  return rocks;
}

}  // namespace rigmap
