#include "adjustment/internal/bundle.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "adjustment/internal/adjusted_points.h"
#include "adjustment/internal/bundle_solver.h"
#include "adjustment/reprojection.h"
#include "core/statistics.h"

namespace rigmap {
namespace {

// Share of the coordinates' freedom that points and poses leave.
double Redundancy(const Bundle& bundle) {
  const auto posed = std::ranges::count_if(bundle.left_from_world,
                                           [](const auto& pose) { return pose.has_value(); });
  const double coordinates = 2.0 * static_cast<double>(ObservationCount(bundle.points));
  const double unknowns =
      3.0 * static_cast<double>(bundle.points.size()) + 6.0 * static_cast<double>(posed);
  return 1.0 - unknowns / std::max(coordinates, 1.0);
}

}  // namespace

void SolveBundle(double huber_px, double function_tolerance, Bundle& bundle) {
  const BundleSolver::Summary summary = BundleSolver(bundle, huber_px).Solve(function_tolerance);
  spdlog::info("bundle: {} iterations, cost {:.6e} to {:.6e}", summary.iterations,
               summary.initial_cost, summary.final_cost);
  if (!summary.settled) {
    spdlog::warn("bundle: not settled after {} iterations", summary.iterations);
  }
}

std::vector<double> ErrorsPx(const Bundle& bundle) {
  std::vector<FrameProjection> frames;
  for (const auto& pose : bundle.left_from_world) {
    frames.emplace_back(bundle.rig, pose.value_or(Rigid3()));
  }
  std::vector<double> errors;
  for (const AdjustedPoint& point : bundle.points) {
    for (const PointObservation& o : point.observations) {
      const auto pixel = frames[o.frame].Project(o.eye, point.x);
      errors.push_back(pixel ? (*pixel - o.pixel).norm() : std::numeric_limits<double>::infinity());
    }
  }
  return errors;
}

void DropBeyond(double limit_px, const std::vector<double>& errors_px, Bundle& bundle) {
  std::size_t next = 0;
  for (AdjustedPoint& point : bundle.points) {
    std::erase_if(point.observations,
                  [&](const PointObservation&) { return !(errors_px[next++] <= limit_px); });
  }
  DropUndetermined(bundle);
}

void DropUndetermined(Bundle& bundle) {
  std::erase_if(bundle.points, [&](const AdjustedPoint& point) {
    return !IsDetermined(point, bundle.rig, bundle.left_from_world);
  });
}

void DropThinFrames(Bundle& bundle) {
  constexpr int kMinObservations = 10;
  for (bool dropped = true; dropped;) {
    dropped = false;
    const std::vector<int> counts = ObservationsPerFrame(bundle);
    for (std::size_t i = 0; i < counts.size(); ++i) {
      if (!bundle.left_from_world[i] || counts[i] >= kMinObservations) continue;
      bundle.left_from_world[i].reset();
      dropped = true;
    }
    for (AdjustedPoint& point : bundle.points) {
      std::erase_if(point.observations,
                    [&](const auto& o) { return !bundle.left_from_world[o.frame]; });
    }
    DropUndetermined(bundle);
  }
}

std::vector<int> ObservationsPerFrame(const Bundle& bundle) {
  std::vector<int> counts(bundle.left_from_world.size(), 0);
  for (const AdjustedPoint& point : bundle.points) {
    for (const PointObservation& observation : point.observations) ++counts[observation.frame];
  }
  return counts;
}

std::size_t ObservationCount(const std::vector<AdjustedPoint>& points) {
  std::size_t count = 0;
  for (const AdjustedPoint& point : points) count += point.observations.size();
  return count;
}

// The median of a Rayleigh distribution is 1.1774 of its sigma. Most observations have fewer
// degrees of freedom than coordinates, so that residuals fall short of the noise; the redundancy
// mends that.
double NoisePx(const std::vector<double>& errors_px, const Bundle& bundle) {
  constexpr double kRayleighMedian = 1.1774;
  return Median(errors_px) / kRayleighMedian / std::sqrt(std::max(Redundancy(bundle), 0.1));
}

double PathExtent_m(const Bundle& bundle) {
  std::optional<Eigen::Vector3d> first;
  double extent_m = 0.0;
  for (const auto& pose : bundle.left_from_world) {
    if (!pose) continue;
    const Eigen::Vector3d position = pose->Inverse().translation;
    if (!first) first = position;
    extent_m = std::max(extent_m, (position - *first).norm());
  }
  return extent_m;
}

}  // namespace rigmap
