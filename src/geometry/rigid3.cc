#include "geometry/rigid3.h"

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

Rigid3 Interpolate(const Rigid3& from, const Rigid3& to, double share) {
  const Eigen::Vector3d turn = LogRotation(from.rotation.conjugate() * to.rotation);
  return {(from.rotation * ExpRotation(share * turn)).normalized(),
          from.translation + share * (to.translation - from.translation)};
}

}  // namespace rigmap
