// How covariances of poses go from one pose to another.
#pragma once

#include "geometry/rigid3.h"

namespace rigmap {

// How an error of a pose at `from` (translation, rotation about gauge axes) moves another at `to`
// to which it is rigidly connected: a rotation of the first moves the second by the lever arm.
inline Matrix6d CarryMatrix(const Rigid3& from, const Rigid3& to) {
  Matrix6d carry = Matrix6d::Identity();
  carry.topRightCorner<3, 3>() = -Skew(to.translation - from.translation);
  return carry;
}

// A step's own covariance (left perturbation of left_from_reference, current axes) about gauge
// axes.
inline Matrix6d Turned(const Matrix6d& step_covariance, const Rigid3& gauge_from_left) {
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() =
      gauge_from_left.rotation.toRotationMatrix();
  return turn * step_covariance * turn.transpose();
}

}  // namespace rigmap
