// A rigid motion as the row of numbers that solvers move.
#pragma once

#include <array>

#include "geometry/rigid3.h"

namespace rigmap {

// Quaternion x y z w, then translation.
using MotionBlock = std::array<double, 7>;

inline MotionBlock ToBlock(const Rigid3& motion) {
  const auto& q = motion.rotation;
  const auto& t = motion.translation;
  return {q.x(), q.y(), q.z(), q.w(), t.x(), t.y(), t.z()};
}

inline Rigid3 FromBlock(const double* block) {
  return {Eigen::Quaterniond(Eigen::Map<const Eigen::Vector4d>(block)),
          Eigen::Map<const Eigen::Vector3d>(block + 4)};
}

}  // namespace rigmap
