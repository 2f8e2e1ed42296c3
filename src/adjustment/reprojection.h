// The reprojection of a point into an eye of the rig, with all its derivatives.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "scene/rig.h"

namespace rigmap {

// d(pixel residual) by: the frame's pose, left_from_world turned by Exp(rotation) and then moved
// (rotation, translation); the point; the right eye's rotation, Exp(rotation) * right_from_left
// about the right camera's centre's place in the left (zero for the left eye); and the logarithm of
// a common factor on all focal lengths.
struct ReprojectionJacobians {
  Eigen::Matrix<double, 2, 6> pose;
  Eigen::Matrix<double, 2, 3> point;
  Eigen::Matrix<double, 2, 3> rig_rotation;
  Eigen::Vector2d log_focal;
};

struct Reprojection {
  Eigen::Vector2d pixel;  // where the point appears
  ReprojectionJacobians jacobians;
};

// `right_from_left` is passed apart from the rig, since it may be under adjustment; its translation
// turns with its rotation, so that the right camera's centre, and so the baseline, stays. Nothing
// if the point lies behind the eye.
std::optional<Reprojection> Reproject(const StereoRig& rig, Eye eye, const Rigid3& right_from_left,
                                      const Rigid3& left_from_world, const Eigen::Vector3d& x);

}  // namespace rigmap
