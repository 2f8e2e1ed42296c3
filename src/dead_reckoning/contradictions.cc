#include "dead_reckoning/contradictions.h"

#include <algorithm>

#include "core/error.h"
#include "dead_reckoning/estimate_motion.h"

namespace rigmap {
namespace {

constexpr double kFlatShare = 0.5, kFlat_m = 0.02, kFlatTurn_rad = 0.1;

bool DifferFlatly(const Rigid3& a, const Rigid3& b) {
  const double way_m = std::max(a.translation.norm(), b.translation.norm());
  return (a.translation - b.translation).norm() > std::max(kFlat_m, kFlatShare * way_m) ||
         LogRotation(a.rotation.conjugate() * b.rotation).norm() > kFlatTurn_rad;
}

}  // namespace

std::optional<Contradictions> FlatContradictions(const Dataset& dataset, const Odometry& odometry,
                                                 const DeadReckoningOptions& options,
                                                 const FilterOptions& filter) {
  const std::vector<VisualStep> visual = VisualSteps(odometry);
  if (visual.empty() || !dataset.rig.imu_from_left) return std::nullopt;
  EstimatedMotion motion;
  try {
    motion = EstimateMotion(dataset, visual, options, filter);
  } catch (const DataError&) {
    return std::nullopt;
  }
  Contradictions found{.frames = {}, .steps = static_cast<int>(visual.size())};
  for (const int frame : motion.misled) {
    const int reference = odometry[frame].reference;
    if (reference >= frame || !motion.poses[frame].is_measured) continue;
    const Rigid3 by_sensors =
        motion.poses[reference].gauge_from_left.Inverse() * motion.poses[frame].gauge_from_left;
    if (DifferFlatly(OdometricStep(odometry, reference, frame), by_sensors)) {
      found.frames.push_back(frame);
    }
  }
  return found;
}

}  // namespace rigmap
