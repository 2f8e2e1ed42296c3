#include "evaluation/internal/rock_truth.h"

#include <algorithm>
#include <iterator>
#include <limits>

#include "core/statistics.h"
#include "evaluation/internal/point_cells.h"

namespace rigmap {
namespace {

// m; beyond the farthest points of a map that are judged with the rock, and a ghost's distance.
constexpr double kSurroundings_m = 0.55;
constexpr double kMargin_m = 0.05;  // of the core: the thickness of a map's sand, and its smear
constexpr double kPatch_m = 0.05;
constexpr double kWholePatch = 0.75;  // so many patches have fewer points than a whole one

template <class Value>
std::vector<Eigen::Vector3d> Pick(const std::vector<Value>& values,
                                  const std::vector<std::uint32_t>& indices) {
  std::vector<Eigen::Vector3d> picked;
  picked.reserve(indices.size());
  for (const auto i : indices) picked.push_back(values[i].template cast<double>());
  return picked;
}

RockPoints PointsAround(const TrueRock& rock, const TrueSurface& surface,
                        std::span<const std::uint32_t> own) {
  const double reach_m = rock.width_m / 2.0 + kSurroundings_m;
  const Eigen::Vector2d centre = rock.x_in_truth.head<2>();
  const auto is_near = [&](std::uint32_t i) {
    const Eigen::Vector2d xy = surface.x_in_truth[i].head<2>().cast<double>();
    return (xy - centre).cwiseAbs().maxCoeff() < reach_m;
  };
  RockPoints points;
  for (std::uint32_t i = 0; i < surface.size(); ++i) {
    if (is_near(i)) points.all.push_back(i);
  }
  std::ranges::copy_if(own, std::back_inserter(points.own), is_near);
  std::ranges::copy_if(points.own, std::back_inserter(points.shown),
                       [&](std::uint32_t i) { return surface.visible[i] != 0; });
  return points;
}

// Of whole patches most have about as many points: the surface's grain and slope make some more.
std::vector<double> PatchAreas(const PointCells& patches) {
  std::vector<double> areas(patches.sizes.begin(), patches.sizes.end());
  if (areas.empty()) return areas;
  auto sorted = areas;
  const double whole = InterpolatedQuantile(sorted, kWholePatch);
  for (double& area : areas) area = std::min(1.0, area / whole);
  return areas;
}

RockCore CoreOf(const RockPoints& points, const TrueSurface& surface) {
  std::vector<std::uint32_t> others;
  std::ranges::set_difference(points.all, points.own, std::back_inserter(others));
  const SearchedSurface other(surface, others);
  std::vector<std::uint32_t> indices;
  for (const auto i : points.shown) {
    if (!other.tree.Nearest(surface.x_in_truth[i].cast<double>(), kMargin_m)) indices.push_back(i);
  }
  RockCore core{.patch_of = std::vector<std::optional<std::uint32_t>>(points.all.size())};
  if (indices.empty()) return core;
  const auto x = Pick(surface.x_in_truth, indices);
  const PointCells patches = SortIntoCells(x, kPatch_m);
  core.patch_area = PatchAreas(patches);
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const auto at = std::ranges::lower_bound(points.all, indices[i]) - points.all.begin();
    core.patch_of[static_cast<std::size_t>(at)] = patches.of_point[i];
    core.centre += x[i] / static_cast<double>(indices.size());
  }
  return core;
}

}  // namespace

SearchedSurface::SearchedSurface(const TrueSurface& surface,
                                 const std::vector<std::uint32_t>& indices)
    : x(Pick(surface.x_in_truth, indices)), normal(Pick(surface.normal, indices)), tree(x) {}

std::vector<std::vector<std::uint32_t>> PointsOfRocks(const MapTruth& truth) {
  std::vector<Eigen::Vector2d> centres;
  for (const TrueRock& rock : truth.rocks) centres.emplace_back(rock.x_in_truth.head<2>());
  const PointTree<Eigen::Vector2d> tree(centres);
  std::vector<std::vector<std::uint32_t>> points(centres.size());
  for (std::uint32_t i = 0; i < truth.surface.size(); ++i) {
    if (truth.surface.kind[i] != kRockKind) continue;
    const Eigen::Vector2d xy = truth.surface.x_in_truth[i].head<2>().cast<double>();
    const auto nearest = tree.Nearest(xy, std::numeric_limits<double>::infinity());
    if (nearest) points[nearest->index].push_back(i);
  }
  return points;
}

RockTruth::RockTruth(const TrueRock& true_rock, const TrueSurface& surface,
                     std::span<const std::uint32_t> own_points)
    : RockTruth(true_rock, surface, PointsAround(true_rock, surface, own_points)) {}

RockTruth::RockTruth(const TrueRock& true_rock, const TrueSurface& surface,
                     const RockPoints& points)
    : rock(true_rock),
      all(surface, points.all),
      own(surface, points.own),
      shown(surface, points.shown),
      core(CoreOf(points, surface)) {}

}  // namespace rigmap
