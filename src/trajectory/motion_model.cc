#include "trajectory/motion_model.h"

#include <algorithm>
#include <cmath>

namespace rigmap {
namespace {

double SecondsBetween(StampNs from, StampNs to) { return 1e-9 * static_cast<double>(to - from); }

// Of frame i from the one before it.
double SpeedMPerS(const Odometry& odometry, std::size_t i) {
  const OdometryFrame &from = odometry[i - 1], &to = odometry[i];
  return (to.world_from_left.translation - from.world_from_left.translation).norm() /
         SecondsBetween(from.stamp_ns, to.stamp_ns);
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
  for (OdometryFrame& frame : odometry) {
    if (frame.source != PoseSource::kPredicted) continue;
    const double seconds =
        std::abs(SecondsBetween(odometry[frame.reference].stamp_ns, frame.stamp_ns));
    const double sigma_m = unmeasured.speed_change_share * fastest_m_per_s * seconds;
    const double sigma_rad = unmeasured.turn_change_rad_per_s * seconds;
    Vector6d variances;
    variances << Eigen::Vector3d::Constant(sigma_m * sigma_m),
        Eigen::Vector3d::Constant(sigma_rad * sigma_rad);
    frame.step_covariance = variances.asDiagonal();
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
