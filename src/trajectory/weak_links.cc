#include "trajectory/weak_links.h"

#include <Eigen/LU>
#include <cmath>

#include "geometry/carried_covariance.h"

namespace rigmap {
namespace {

// Of a frame that images or sensors posed against one before it, in the same group of adjusted
// frames.
bool IsWeak(int frame, const Odometry& odometry, const Adjustment& adjustment) {
  constexpr double kTimes = 3.0, kMostSigmas = 3.0;
  const int reference = odometry[frame].reference;
  const Rigid3 &from = *adjustment.world_from_left[reference],
               &to = *adjustment.world_from_left[frame];
  // Of the noise alone: calibration errs on both sides of a link alike.
  const Matrix6d &adjusted = *adjustment.link_covariances[frame],
                 odometric = Turned(odometry[frame].step_covariance, to);
  const auto variance = [](const Matrix6d& covariance) {
    return covariance.topLeftCorner<3, 3>().trace();
  };
  if (!(variance(adjusted) > kTimes * kTimes * variance(odometric))) return false;
  const Eigen::Vector3d apart =
      to.translation - (from * OdometricStep(odometry, reference, frame)).translation;
  const Eigen::Matrix3d both = (adjusted + odometric).topLeftCorner<3, 3>();
  return apart.dot(both.inverse() * apart) < 3.0 * kMostSigmas * kMostSigmas;
}

}  // namespace

std::vector<int> WeakLinks(const Odometry& odometry, const Adjustment& adjustment) {
  std::vector<int> weak;
  if (adjustment.link_covariances.empty()) return weak;
  const int count = static_cast<int>(odometry.size());
  const auto is_tied = [&](int i) {
    const int reference = odometry[i].reference;
    return reference < i && odometry[i].source == PoseSource::kOdometry &&
           adjustment.link_covariances[i].has_value();
  };
  std::vector<bool> is_weak(odometry.size(), false);
  for (int i = 0; i < count; ++i) is_weak[i] = is_tied(i) && IsWeak(i, odometry, adjustment);
  for (int i = 0; i < count; ++i) {
    if (!is_weak[i]) continue;
    bool all = true;
    for (int k = i; k < count && all; ++k) {
      all = odometry[k].reference >= i || !is_tied(k) || is_weak[k];
    }
    if (all) weak.push_back(i);
  }
  return weak;
}

}  // namespace rigmap
