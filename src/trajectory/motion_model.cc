#include "trajectory/motion_model.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/stamp_steps.h"

namespace rigmap {
namespace {

// Of frame i from the one before it.
double SpeedMPerS(const Odometry& odometry, std::size_t i) {
  const OdometryFrame &from = odometry[i - 1], &to = odometry[i];
  return (to.world_from_left.translation - from.world_from_left.translation).norm() /
         SecondsBetween(from.stamp_ns, to.stamp_ns);
}

double SecondsOfStep(const Odometry& odometry, std::size_t i) {
  return std::abs(SecondsBetween(odometry[odometry[i].reference].stamp_ns, odometry[i].stamp_ns));
}

// Per frame, how long nothing has been measured; 0 for those that were.
std::vector<double> UnmeasuredSeconds(const Odometry& odometry) {
  std::vector<double> seconds(odometry.size(), 0.0);
  const auto go_on = [&](std::size_t i) {
    if (odometry[i].source != PoseSource::kPredicted) return;
    seconds[i] = seconds[odometry[i].reference] + SecondsOfStep(odometry, i);
  };
  // Those that lie before the first one measured hang on later ones.
  for (std::size_t i = 0; i < odometry.size(); ++i) {
    if (odometry[i].reference < static_cast<int>(i)) go_on(i);
  }
  for (std::size_t i = odometry.size(); i-- > 0;) {
    if (odometry[i].reference > static_cast<int>(i)) go_on(i);
  }
  return seconds;
}

}  // namespace

Rigid3 PredictPose(const Odometry& so_far, StampNs stamp_ns) {
  const std::size_t count = so_far.size();
  if (count < 2) return so_far.back().world_from_left;
  const OdometryFrame &last = so_far[count - 1], &before = so_far[count - 2];
  const double step_s = SecondsBetween(before.stamp_ns, last.stamp_ns);
  const double ahead = SecondsBetween(last.stamp_ns, stamp_ns) / step_s;
  // Carried on in the rover's own axes, so that a curve goes on as a curve.
  const Rigid3 motion = before.world_from_left.Inverse() * last.world_from_left;
  const Rigid3 carried{ExpRotation(ahead * LogRotation(motion.rotation)),
                       ahead * motion.translation};
  return last.world_from_left * carried;
}

void SetPredictionCovariances(Odometry& odometry, const UnmeasuredMotion& unmeasured) {
  double fastest_m_per_s = 0.0;
  for (std::size_t i = 1; i < odometry.size(); ++i) {
    fastest_m_per_s = std::max(fastest_m_per_s, SpeedMPerS(odometry, i));
  }
  // Where nothing was seen to move, nothing is known of the speed: a walking pace.
  constexpr double kUnknownSpeed_m_per_s = 1.0;
  if (fastest_m_per_s == 0.0) fastest_m_per_s = kUnknownSpeed_m_per_s;
  const double sigma_m_per_s = unmeasured.speed_change_share * fastest_m_per_s;
  const double sigma_rad_per_s = unmeasured.turn_change_rad_per_s;
  const std::vector<double> seconds = UnmeasuredSeconds(odometry);
  for (std::size_t i = 0; i < odometry.size(); ++i) {
    if (odometry[i].source != PoseSource::kPredicted) continue;
    // What steps add to the square of the time, however many they are.
    const double before_s = std::max(0.0, seconds[i] - SecondsOfStep(odometry, i));
    const double squares_s2 = seconds[i] * seconds[i] - before_s * before_s;
    Vector6d variances;
    variances << Eigen::Vector3d::Constant(sigma_m_per_s * sigma_m_per_s * squares_s2),
        Eigen::Vector3d::Constant(sigma_rad_per_s * sigma_rad_per_s * squares_s2);
    odometry[i].step_covariance = variances.asDiagonal();
  }
}

void BridgePredicted(Odometry& odometry) {
  const int count = static_cast<int>(odometry.size());
  for (int first = 1; first < count; ++first) {
    if (odometry[first].source != PoseSource::kPredicted) continue;
    int end = first;
    while (end < count && odometry[end].source == PoseSource::kPredicted) ++end;
    // Beyond the gap the motion must have been measured against a frame before it.
    if (end < count && odometry[end].reference < first) {
      const OdometryFrame &from = odometry[first - 1], &to = odometry[end];
      const double gap_s = SecondsBetween(from.stamp_ns, to.stamp_ns);
      for (int i = first; i < end; ++i) {
        odometry[i].world_from_left =
            Interpolate(from.world_from_left, to.world_from_left,
                        SecondsBetween(from.stamp_ns, odometry[i].stamp_ns) / gap_s);
      }
    }
    first = end;
  }
}

}  // namespace rigmap
