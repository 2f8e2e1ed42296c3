#include "geometry/rigid3.h"

#include <Eigen/LU>
#include <cmath>

namespace rigmap {

Eigen::Vector3d LogRotation(const Eigen::Quaterniond& rotation) {
  const double sign = rotation.w() < 0.0 ? -1.0 : 1.0;
  const Eigen::Vector3d vec = sign * rotation.vec();
  const double sine = vec.norm();
  if (sine < 1e-12) return 2.0 * vec;
  return vec * (2.0 * std::atan2(sine, sign * rotation.w()) / sine);
}

Eigen::Quaterniond ExpRotation(const Eigen::Vector3d& rotation_vector) {
  const double angle = rotation_vector.norm();
  if (angle < 1e-12) {
    return Eigen::Quaterniond(1.0, 0.5 * rotation_vector.x(), 0.5 * rotation_vector.y(),
                              0.5 * rotation_vector.z())
        .normalized();
  }
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, rotation_vector / angle));
}

Eigen::Matrix3d Skew(const Eigen::Vector3d& a) {
  Eigen::Matrix3d m;
  m << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return m;
}

namespace {

// Where a constant motion has got to after unit time, if it moves by I and turns by `turn` in its
// own axes: the translation is this times I.
Eigen::Matrix3d LeftJacobian(const Eigen::Vector3d& turn) {
  const double angle = turn.norm();
  const Eigen::Matrix3d skew = Skew(turn);
  constexpr double kSmall = 1e-4;  // there the series are exact to rounding
  const double a = angle < kSmall ? 0.5 : (1.0 - std::cos(angle)) / (angle * angle);
  const double b = angle < kSmall ? 1.0 / 6.0 : (angle - std::sin(angle)) / (angle * angle * angle);
  return Eigen::Matrix3d::Identity() + a * skew + b * skew * skew;
}

}  // namespace

Rigid3 Interpolate(const Rigid3& from, const Rigid3& to, double share) {
  const Rigid3 motion = from.Inverse() * to;
  const Eigen::Vector3d turn = LogRotation(motion.rotation);
  const Eigen::Vector3d speed = LeftJacobian(turn).partialPivLu().solve(motion.translation);
  return from * Rigid3{ExpRotation(share * turn), LeftJacobian(share * turn) * (share * speed)};
}

}  // namespace rigmap
