// Perturbations of rigid motions, carried from one frame's axes into another's.
#pragma once

#include "geometry/rigid3.h"

namespace rigmap {

// How a perturbation (translation, rotation) on the left of some motion shows on the left of
// `motion` times it: exp(Adjoint(motion) p) * motion * x == motion * exp(p) * x, to first order.
inline Eigen::Matrix<double, 6, 6> Adjoint(const Rigid3& motion) {
  const Eigen::Matrix3d turn = motion.rotation.toRotationMatrix();
  Eigen::Matrix<double, 6, 6> adjoint = Eigen::Matrix<double, 6, 6>::Zero();
  adjoint.topLeftCorner<3, 3>() = adjoint.bottomRightCorner<3, 3>() = turn;
  adjoint.topRightCorner<3, 3>() = Skew(motion.translation) * turn;
  return adjoint;
}

}  // namespace rigmap
