#include "adjustment/internal/bundle.h"

#include <spdlog/spdlog.h>

#include <limits>

#include "adjustment/internal/adjusted_points.h"
#include "adjustment/internal/bundle_solver.h"
#include "adjustment/reprojection.h"

namespace rigmap {
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

}  // namespace rigmap
