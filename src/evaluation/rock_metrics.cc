#include "evaluation/rock_metrics.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <iterator>
#include <limits>
#include <span>

#include "evaluation/internal/rock_deformation.h"
#include "evaluation/internal/rock_top.h"
#include "evaluation/internal/rock_truth.h"
#include "evaluation/internal/rock_view.h"

namespace rigmap {
namespace {

constexpr double kMaxFromPath_m = 3.5;           // as far as maps are judged
constexpr std::size_t kMinVisiblePoints = 1000;  // a third of a small rock
constexpr double kComplete_m = 0.02;             // two grains of the surface
constexpr double kAround_m = 0.3;                // where a second copy would stand
constexpr double kBesideSquare_m = 0.45;         // from the rock's square: as far as it goes on
constexpr double kFit_m = 0.12;                  // twice what a fit takes in
constexpr double kOverSand_m = 0.05;             // so that the sand around is left out
constexpr double kGhost_m = 0.03, kFarGhost_m = 0.04;  // from all that exists
constexpr double kSurfaceGrain_m = 0.03;               // in plan: farther, the truth ends

using Points = std::vector<Eigen::Vector3d>;

double FromPath(const TrueRock& rock, const std::vector<TumPose>& path) {
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const TumPose& pose : path) {
    const Eigen::Vector3d offset = pose.world_from_body.translation - rock.x_in_truth;
    nearest_m = std::min(nearest_m, offset.head<2>().norm());
  }
  return nearest_m;
}

// The map's points within kAround_m of the rock's visible surface, and beside its square.
Points MapPointsAt(const RockTruth& truth, const MapOverTruth& map) {
  Eigen::AlignedBox3d box;
  for (const auto& x : truth.shown.x) box.extend(x);
  const double radius_m = box.diagonal().norm() / 2.0 + kAround_m;
  const double square_m = truth.rock.width_m / 2.0 + kBesideSquare_m;
  Points points;
  for (const auto i : map.MapPointsWithin(box.center(), radius_m)) {
    const Eigen::Vector3d x = map.MapPoint(i), from_rock = x - truth.rock.x_in_truth;
    if (!(from_rock.head<2>().cwiseAbs().maxCoeff() < square_m)) continue;
    if (truth.shown.tree.Nearest(x, kAround_m)) points.push_back(x);
  }
  return points;
}

Points WithinReachOfFit(const Points& points, const RockTruth& truth) {
  Points close;
  std::ranges::copy_if(points, std::back_inserter(close), [&](const Eigen::Vector3d& x) {
    return truth.shown.tree.Nearest(x, kFit_m).has_value();
  });
  return close;
}

double Completeness(const RockTruth& truth, const Points& map_points) {
  const PointTree<Eigen::Vector3d> tree(map_points);
  const auto mapped = std::ranges::count_if(truth.shown.x, [&](const Eigen::Vector3d& x) {
    return tree.Nearest(x, kComplete_m).has_value();
  });
  return static_cast<double>(mapped) / static_cast<double>(truth.shown.size());
}

// The horizontal part of the shift undone; `points` themselves where none is known.
Points UndoShift(Points points, const std::optional<RockShift>& shift,
                 const Eigen::Matrix3d& axes) {
  if (!shift) return points;
  const Eigen::Vector3d by_m = axes.topRows<2>().transpose() * shift->along_axes_m.head<2>();
  for (auto& x : points) x -= by_m;
  return points;
}

std::optional<RockGhosts> GhostsAround(const RockTruth& truth, const Points& map_points) {
  std::vector<Eigen::Vector2d> plan;
  for (const auto& x : truth.all.x) plan.emplace_back(x.head<2>());
  const PointTree<Eigen::Vector2d> plan_tree(plan);
  double over_sand = 0.0;
  RockGhosts ghosts;
  for (const auto& x : map_points) {
    if (!(x.z() > truth.rock.x_in_truth.z() + kOverSand_m)) continue;
    ++over_sand;
    if (!plan_tree.Nearest(x.head<2>(), kSurfaceGrain_m)) continue;
    if (!truth.all.tree.Nearest(x, kGhost_m)) ++ghosts.over_3cm_share;
    if (!truth.all.tree.Nearest(x, kFarGhost_m)) ++ghosts.over_4cm_share;
  }
  if (over_sand == 0.0) return std::nullopt;
  return RockGhosts{ghosts.over_3cm_share / over_sand, ghosts.over_4cm_share / over_sand};
}

void Judge(const RockTruth& truth, const MapOverTruth& map, RockMetrics& metrics) {
  const Points points = MapPointsAt(truth, map);
  if (points.empty()) return;
  metrics.completeness = Completeness(truth, points);
  const Eigen::Matrix3d axes = ViewAxes(truth.shown.x, map.truth().path);
  const Points close = WithinReachOfFit(points, truth);
  metrics.shift = FitShift(close, truth, axes);
  metrics.stretch = FitStretch(close, truth, axes);
  metrics.top_m = TopOverTruth(UndoShift(points, metrics.shift, axes), truth);
  metrics.ghosts = GhostsAround(truth, points);
}

std::optional<RockMetrics> JudgeRock(const TrueRock& rock, std::span<const std::uint32_t> own,
                                     const MapOverTruth& map) {
  const TrueSurface& surface = map.truth().surface;
  const auto shown = static_cast<std::size_t>(
      std::ranges::count_if(own, [&](std::uint32_t i) { return surface.visible[i] != 0; }));
  const double from_path_m = FromPath(rock, map.truth().path);
  if (from_path_m > kMaxFromPath_m || shown < kMinVisiblePoints) return std::nullopt;
  const RockTruth truth(rock, surface, own);
  RockMetrics metrics{
      .rock = rock, .from_path_m = from_path_m, .visible_points = truth.shown.size()};
  if (truth.shown.size() > 0) Judge(truth, map, metrics);
  return metrics;
}

}  // namespace

std::vector<RockMetrics> CompareRocks(const MapOverTruth& map) {
  const auto own = PointsOfRocks(map.truth());
  std::vector<std::optional<RockMetrics>> judged(own.size());
  tbb::parallel_for(std::size_t{0}, judged.size(), [&](std::size_t i) {
    judged[i] = JudgeRock(map.truth().rocks[i], own[i], map);
  });
  std::vector<RockMetrics> rocks;
  for (auto& rock : judged) {
    if (rock) rocks.push_back(std::move(*rock));
  }
  return rocks;
}

}  // namespace rigmap
