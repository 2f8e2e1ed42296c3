#include "dead_reckoning/bridge_gaps.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "dead_reckoning/estimate_motion.h"

namespace rigmap {
namespace {

bool IsPredicted(const OdometryFrame& frame) { return frame.source == PoseSource::kPredicted; }

// Predicted frames that a later measured one hangs on, directly or by way of other predicted ones:
// those that lie between two measured ones are held by both already.
std::vector<int> Lost(const Odometry& odometry) {
  std::vector<char> carries(odometry.size(), 0);
  for (int i = static_cast<int>(odometry.size()) - 1; i > 0; --i) {
    const OdometryFrame& frame = odometry[i];
    if (frame.reference >= i) continue;
    if (!IsPredicted(frame) || carries[i]) carries[frame.reference] = 1;
  }
  std::vector<int> lost;
  for (int i = 1; i < static_cast<int>(odometry.size()); ++i) {
    if (IsPredicted(odometry[i]) && carries[i] && odometry[i].reference == i - 1) lost.push_back(i);
  }
  return lost;
}

// By how much the later pose is known less, the same in all directions: what is left of a
// difference of covariances need not be one.
Matrix6d Growth(const EstimatedPose& before, const EstimatedPose& after) {
  constexpr double kLeast_m = 1e-3, kLeast_rad = 1e-4;
  const auto grown = [&](int first, double least) {
    const double more = (after.covariance - before.covariance).block<3, 3>(first, first).trace();
    return std::max(least * least, more / 3.0);
  };
  Vector6d variances;
  variances << Eigen::Vector3d::Constant(grown(0, kLeast_m)),
      Eigen::Vector3d::Constant(grown(3, kLeast_rad));
  return variances.asDiagonal();
}

}  // namespace

BridgedOdometry BridgeGaps(const Dataset& dataset, Odometry odometry,
                           const DeadReckoningOptions& options, const FilterOptions& filter) {
  BridgedOdometry result{std::move(odometry), {}};
  const std::vector<int> lost = Lost(result.odometry);
  if (lost.empty()) return result;
  const std::vector<VisualStep> visual = VisualSteps(result.odometry);
  EstimatedMotion motion;
  try {
    motion = EstimateMotion(dataset, visual, options, filter);
  } catch (const DataError& error) {
    spdlog::info("nothing bridges the frames that the odometry lost: {}", error.what());
    return result;
  }
  if (2 * motion.slips.size() > visual.size()) {
    spdlog::warn("wheels and images contradict each other in {} of {} steps: wheels bridge nothing",
                 motion.slips.size(), visual.size());
    return result;
  }
  // In order, so that what hangs on a frame follows it.
  const Odometry before = result.odometry;
  for (int i = 1; i < static_cast<int>(before.size()); ++i) {
    OdometryFrame& frame = result.odometry[i];
    if (frame.reference >= i) continue;
    Rigid3 step = OdometricStep(before, frame.reference, i);
    if (std::ranges::binary_search(lost, i) && motion.poses[i].is_measured) {
      step = motion.poses[i - 1].gauge_from_left.Inverse() * motion.poses[i].gauge_from_left;
      frame.step_covariance = Growth(motion.poses[i - 1], motion.poses[i]);
      frame.source = PoseSource::kOdometry;
      result.bridged.push_back(i);
    }
    frame.world_from_left = result.odometry[frame.reference].world_from_left * step;
  }
  return result;
}

}  // namespace rigmap
