// Rigid motions and similarities. b_from_a maps a's coordinates to b's, so that compositions
// cancel by eye: c_from_a = c_from_b * b_from_a.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace rigmap {

// x_in_b = rotation * x_in_a + translation. `rotation` is a unit quaternion.
struct Rigid3 {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& x) const { return rotation * x + translation; }
  Rigid3 operator*(const Rigid3& other) const {
    return {(rotation * other.rotation).normalized(), rotation * other.translation + translation};
  }
  Rigid3 Inverse() const {
    const Eigen::Quaterniond inverse = rotation.conjugate();
    return {inverse, -(inverse * translation)};
  }
};

// x_in_b = scale * (rotation * x_in_a) + translation; scale > 0.
struct Sim3 {
  double scale = 1.0;
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& x) const {
    return scale * (rotation * x) + translation;
  }
  Sim3 operator*(const Sim3& other) const {
    return {scale * other.scale, (rotation * other.rotation).normalized(),
            scale * (rotation * other.translation) + translation};
  }
  Sim3 Inverse() const {
    const Eigen::Quaterniond inverse = rotation.conjugate();
    return {1.0 / scale, inverse, -(inverse * translation) / scale};
  }
};

// The pose world_from_camera of a camera whose pose in the model is model_from_camera: its centre
// is mapped by the similarity, its axes are rotated.
inline Rigid3 TransformPose(const Sim3& world_from_model, const Rigid3& model_from_camera) {
  return {(world_from_model.rotation * model_from_camera.rotation).normalized(),
          world_from_model * model_from_camera.translation};
}

// Angle of a rotation in radians, 0 to pi.
inline double AngleOf(const Eigen::Quaterniond& rotation) {
  return 2.0 * std::atan2(rotation.vec().norm(), std::abs(rotation.w()));
}

// Rotation vector (axis times angle, radians) and back.
Eigen::Vector3d LogRotation(const Eigen::Quaterniond& rotation);
Eigen::Quaterniond ExpRotation(const Eigen::Vector3d& rotation_vector);

// The cross-product matrix: Skew(a) * b == a.cross(b).
Eigen::Matrix3d Skew(const Eigen::Vector3d& a);

// The pose between two others on the screw motion that leads from one to the other, as a rover that
// keeps its speed and its curve: share 0 gives `from`, 1 gives `to`; beyond, the motion goes on.
Rigid3 Interpolate(const Rigid3& from, const Rigid3& to, double share);

}  // namespace rigmap
