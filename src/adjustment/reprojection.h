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

// By a turn of the right eye about its own axes, as by an unknown pose of which nothing is moved by
// the last three coordinates.
inline Eigen::Matrix<double, 2, 6> ByTurn(const ReprojectionJacobians& jacobians) {
  Eigen::Matrix<double, 2, 6> by_turn = Eigen::Matrix<double, 2, 6>::Zero();
  by_turn.leftCols<3>() = jacobians.calibration.middleCols<3>(kRotationX);
  return by_turn;
}

struct Reprojection {
  Eigen::Vector2d pixel;  // where the point appears
  ReprojectionJacobians jacobians;
};

// Nothing if the point lies behind the eye.
std::optional<Reprojection> Reproject(const StereoRig& rig, Eye eye, const Rigid3& left_from_world,
                                      const Eigen::Vector3d& x);

// The same for many points of one frame, without the calibration's derivatives. `rig` must outlive
// it.
class FrameProjection {
 public:
  struct Linearised {
    Eigen::Vector2d pixel;
    Eigen::Matrix<double, 2, 6> by_pose;
    Eigen::Matrix<double, 2, 3> by_point;
  };

  FrameProjection(const StereoRig& rig, const Rigid3& left_from_world);

  std::optional<Eigen::Vector2d> Project(Eye eye, const Eigen::Vector3d& x) const;
  std::optional<Linearised> Linearise(Eye eye, const Eigen::Vector3d& x) const;

 private:
  const StereoRig& rig_;
  Eigen::Matrix3d turn_, right_turn_;  // left_from_world, right_from_left
  Eigen::Vector3d translation_;
};

}  // namespace rigmap
