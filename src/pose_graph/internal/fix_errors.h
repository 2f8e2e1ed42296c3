// Residuals of poses that are tied to fixes (fuse_fixes.h), for Ceres.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "geometry/rigid3.h"
#include "pose_graph/fuse_fixes.h"
#include "pose_graph/internal/step_noise.h"

namespace rigmap {

template <class Scalar>
using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
template <class Scalar>
using Rotation = Eigen::Quaternion<Scalar>;

template <class Scalar>
Rotation<Scalar> ToRotation(const Scalar* vector) {
  // First order is enough: it is small, or its first part (about up) is found step by step.
  Rotation<Scalar> q(Scalar(1.0), Scalar(0.5) * vector[0], Scalar(0.5) * vector[1],
                     Scalar(0.5) * vector[2]);
  q.normalize();
  return q;
}

// The motion from pose i to the next, in sigmas; blocks: the two poses, the scale.
struct StepError {
  Rigid3 a_from_b;
  StepNoise noise;

  template <class Scalar>
  bool operator()(const Scalar* a, const Scalar* b, const Scalar* scale, Scalar* residual) const {
    const Eigen::Map<const Rotation<Scalar>> turn_a(a), turn_b(b);
    const Eigen::Map<const Vector3<Scalar>> x_a(a + 4), x_b(b + 4);
    const Rotation<Scalar> a_from_world = turn_a.conjugate();
    const Vector3<Scalar> moved = a_from_world * (x_b - x_a);
    const Vector3<Scalar> off = moved - scale[0] * a_from_b.translation.template cast<Scalar>();
    const Rotation<Scalar> turned =
        a_from_world * turn_b * a_from_b.rotation.conjugate().template cast<Scalar>();
    const Scalar sign = turned.w() < Scalar(0.0) ? Scalar(-2.0) : Scalar(2.0);
    for (int k = 0; k < 3; ++k) {
      residual[k] = off[k] / noise.metres;
      residual[3 + k] = sign * turned.vec()[k] / noise.radians;
    }
    return true;
  }
};

// A fix, in sigmas; blocks: the poses before and after it, the correction of enu_from_world (turn,
// then shift), the clock.
struct FixError {
  AntennaFix fix;
  double share = 0.0;        // of the way from one pose to the next
  Eigen::Vector3d velocity;  // in the world, m/s
  Eigen::Vector3d antenna_in_left;
  Rigid3 enu_from_world;
  double sigma_factor = 1.0;

  template <class Scalar>
  bool operator()(const Scalar* a, const Scalar* b, const Scalar* frame, const Scalar* clock,
                  Scalar* residual) const {
    const auto antenna = [&](const Scalar* pose) -> Vector3<Scalar> {
      const Eigen::Map<const Rotation<Scalar>> turn(pose);
      const Eigen::Map<const Vector3<Scalar>> x(pose + 4);
      return turn * antenna_in_left.template cast<Scalar>() + x;
    };
    // A receiver's clock that is ahead stamps a place that was passed earlier.
    const Vector3<Scalar> x_in_world = Scalar(1.0 - share) * antenna(a) +
                                       Scalar(share) * antenna(b) -
                                       clock[0] * velocity.template cast<Scalar>();
    const Vector3<Scalar> x_in_enu = enu_from_world.rotation.template cast<Scalar>() * x_in_world +
                                     enu_from_world.translation.template cast<Scalar>();
    const Vector3<Scalar> x =
        ToRotation(frame) * x_in_enu + Vector3<Scalar>(frame[3], frame[4], frame[5]);
    for (int k = 0; k < 3; ++k) {
      residual[k] = (x[k] - Scalar(fix.x_in_enu[k])) / Scalar(sigma_factor * fix.sigma_m[k]);
    }
    return true;
  }
};

// Prior of single numbers: zero, or one, with these sigmas.
template <int kCount>
struct Prior {
  Eigen::Matrix<double, kCount, 1> mean, sigma;

  template <class Scalar>
  bool operator()(const Scalar* x, Scalar* residual) const {
    for (int k = 0; k < kCount; ++k) residual[k] = (x[k] - Scalar(mean[k])) / Scalar(sigma[k]);
    return true;
  }
};

}  // namespace rigmap
