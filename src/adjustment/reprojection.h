// The reprojection of a point into an eye of the rig, with all its derivatives.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "scene/calibration.h"
#include "scene/rig.h"

namespace rigmap {

// d(pixel residual) by: the frame's pose, left_from_world turned by Exp(rotation) and then moved
// (rotation, translation); the point; and the rig's calibration.
struct ReprojectionJacobians {
  Eigen::Matrix<double, 2, 6> pose;
  Eigen::Matrix<double, 2, 3> point;
  Eigen::Matrix<double, 2, kCalibrationSize> calibration;
};

struct Reprojection {
  Eigen::Vector2d pixel;  // where the point appears
  ReprojectionJacobians jacobians;
};

// Nothing if the point lies behind the eye.
std::optional<Reprojection> Reproject(const StereoRig& rig, Eye eye, const Rigid3& left_from_world,
                                      const Eigen::Vector3d& x);

}  // namespace rigmap
