#include "evaluation/internal/rock_top.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <vector>

#include "core/statistics.h"
#include "evaluation/internal/point_cells.h"

namespace rigmap {
namespace {

constexpr double kTopRadius_m = 0.025;
constexpr double kTopDepth_m = 0.05;        // lower points are a flank, or a crack
constexpr double kLeastUpward = 0.3;        // of a normal's z: steeper faces tell no height
constexpr double kTopHidden_m = 0.03;       // the visible points end so far below the highest
constexpr double kTopGate_m = 0.06;         // farther points may be another surface
constexpr double kTopPlaneReach_m = 0.005;  // half of the truth's grain: as far as its planes hold
constexpr double kCovered_m = 0.015;        // a grain of the map and half of one
constexpr double kMinCovered = 0.5;
constexpr double kTopCell_m = 0.01;  // a grain of the map
constexpr double kTopMissing_m = 0.015;
constexpr std::size_t kTopRank = 3;  // of cells by height: one or two may be flying points

struct TopSurface {
  std::vector<Eigen::Vector3d> x, normal;
  std::vector<Eigen::Vector2d> plan;
};

std::optional<TopSurface> FindTop(const RockTruth& truth) {
  const auto height = [](const Eigen::Vector3d& x) { return x.z(); };
  const auto& shown = truth.shown;
  const Eigen::Vector3d peak = *std::ranges::max_element(shown.x, {}, height);
  const double highest_m = std::ranges::max_element(truth.own.x, {}, height)->z();
  if (peak.z() < highest_m - kTopHidden_m) return std::nullopt;
  TopSurface top;
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const Eigen::Vector3d& x = shown.x[i];
    const bool near = (x - peak).head<2>().norm() < kTopRadius_m && x.z() > peak.z() - kTopDepth_m;
    if (!near || !(shown.normal[i].z() > kLeastUpward)) continue;
    top.x.push_back(x);
    top.normal.push_back(shown.normal[i]);
    top.plan.emplace_back(x.head<2>());
  }
  return top.x.empty() ? std::nullopt : std::make_optional(std::move(top));
}

// The third highest cubic centimetre's mean height; the lowest of fewer.
double HeightOfThirdCell(const std::vector<Eigen::Vector3d>& points) {
  std::vector<double> heights_m;
  for (const auto& x : points) heights_m.push_back(x.z());
  auto means = MeansOfCells(SortIntoCells(points, kTopCell_m), heights_m);
  const auto rank = static_cast<std::ptrdiff_t>(std::min(kTopRank, means.size()) - 1);
  std::ranges::nth_element(means, means.begin() + rank, std::greater<>());
  return means[static_cast<std::size_t>(rank)];
}

// Map points over the top, and how far each lies above the surface.
struct PointsOverTop {
  std::vector<Eigen::Vector3d> x;
  std::vector<double> above_m;
};

PointsOverTop FindOverTop(const std::vector<Eigen::Vector3d>& map_points, const TopSurface& top) {
  const PointTree<Eigen::Vector2d> tree(top.plan);
  PointsOverTop over;
  for (const auto& x : map_points) {
    const auto nearest = tree.Nearest(x.head<2>(), kTopPlaneReach_m);
    if (!nearest) continue;
    const Eigen::Vector3d offset = x - top.x[nearest->index];
    if (!(std::abs(offset.z()) < kTopGate_m)) continue;
    const Eigen::Vector3d& normal = top.normal[nearest->index];
    over.x.push_back(x);
    over.above_m.push_back(offset.z() + normal.head<2>().dot(offset.head<2>()) / normal.z());
  }
  return over;
}

bool IsCovered(const TopSurface& top, const PointsOverTop& over) {
  std::vector<Eigen::Vector2d> plan;
  for (const auto& x : over.x) plan.emplace_back(x.head<2>());
  const PointTree<Eigen::Vector2d> tree(plan);
  const auto covered = std::ranges::count_if(
      top.plan, [&](const auto& xy) { return tree.Nearest(xy, kCovered_m).has_value(); });
  return static_cast<double>(covered) >= kMinCovered * static_cast<double>(top.plan.size());
}

}  // namespace

std::optional<double> TopOverTruth(std::span<const Eigen::Vector3d> map_points,
                                   const RockTruth& truth) {
  const auto top = FindTop(truth);
  std::vector<Eigen::Vector3d> close;
  std::ranges::copy_if(map_points, std::back_inserter(close), [&](const Eigen::Vector3d& x) {
    return truth.shown.tree.Nearest(x, kTopGate_m).has_value();
  });
  if (!top || close.empty()) return std::nullopt;
  const double level_m = HeightOfThirdCell(close) - HeightOfThirdCell(truth.shown.x);
  const PointsOverTop over = FindOverTop(close, *top);
  if (over.x.empty() || !IsCovered(*top, over)) return level_m;
  auto above_m = MeansOfCells(SortIntoColumns(over.x, kTopCell_m), over.above_m);
  const double here_m = InterpolatedQuantile(above_m, 0.5);
  return level_m < here_m - kTopMissing_m ? level_m : here_m;
}

}  // namespace rigmap
