#include "adjustment/reprojection.h"

namespace rigmap {
namespace {

constexpr double kMinDepth = 1e-6;

}  // namespace

std::optional<Reprojection> Reproject(const StereoRig& rig, Eye eye, const Rigid3& left_from_world,
                                      const Eigen::Vector3d& x) {
  const Camera& camera = rig.Of(eye).camera;
  const Rigid3& right_from_left = rig.right_from_left;
  const Eigen::Vector3d turned = left_from_world.rotation * x;
  const Eigen::Vector3d in_left = turned + left_from_world.translation;
  const bool is_left = eye == Eye::kLeft;
  const Eigen::Vector3d in_eye = is_left ? in_left : right_from_left * in_left;
  if (!(in_left.z() > kMinDepth) || !(in_eye.z() > kMinDepth)) return std::nullopt;

  Reprojection result;
  Eigen::Matrix2d distortion;
  const Eigen::Vector2d normalised = in_eye.hnormalized();
  result.pixel = Distort(camera, normalised, distortion);
  Eigen::Matrix<double, 2, 3> projection;
  projection << 1.0, 0.0, -normalised.x(), 0.0, 1.0, -normalised.y();
  const Eigen::Matrix<double, 2, 3> by_eye = distortion * projection / in_eye.z();
  const Eigen::Matrix<double, 2, 3> by_left =
      is_left ? by_eye
              : Eigen::Matrix<double, 2, 3>(by_eye * right_from_left.rotation.toRotationMatrix());
  const Eigen::Vector2d from_centre = result.pixel - Eigen::Vector2d(camera.cx, camera.cy);
  const Eigen::Vector2d by_aspect(0.0, from_centre.y());
  ReprojectionJacobians& jacobians = result.jacobians;
  jacobians.pose << -by_left * Skew(turned), by_left;
  jacobians.point = by_left * left_from_world.rotation.toRotationMatrix();
  jacobians.calibration.setZero();
  if (!is_left) {
    jacobians.calibration.middleCols<3>(kRotationX) = -by_eye * Skew(in_eye);
    jacobians.calibration.col(kLogRightFocal) = from_centre;
    jacobians.calibration.col(kLogRightAspect) = by_aspect;
  }
  jacobians.calibration.col(kLogFocal) = from_centre;
  jacobians.calibration.col(kLogAspect) = by_aspect;
  jacobians.calibration.middleCols<2>(is_left ? kLeftCx : kRightCx).setIdentity();
  const double u = normalised.x(), v = normalised.y(), r2 = normalised.squaredNorm();
  const Eigen::Vector2d radial(camera.fx * u, camera.fy * v);
  jacobians.calibration.middleCols<4>(is_left ? kLeftK1 : kRightK1) << r2 * radial,
      r2 * r2 * radial, Eigen::Vector2d(2.0 * camera.fx * u * v, camera.fy * (r2 + 2.0 * v * v)),
      Eigen::Vector2d(camera.fx * (r2 + 2.0 * u * u), 2.0 * camera.fy * u * v);
  return result;
}

FrameProjection::FrameProjection(const StereoRig& rig, const Rigid3& left_from_world)
    : rig_(rig),
      turn_(left_from_world.rotation.toRotationMatrix()),
      right_turn_(rig.right_from_left.rotation.toRotationMatrix()),
      translation_(left_from_world.translation) {}

std::optional<Eigen::Vector2d> FrameProjection::Project(Eye eye, const Eigen::Vector3d& x) const {
  const Eigen::Vector3d in_left = turn_ * x + translation_;
  const Eigen::Vector3d in_eye =
      eye == Eye::kLeft ? in_left
                        : Eigen::Vector3d(right_turn_ * in_left + rig_.right_from_left.translation);
  if (!(in_left.z() > kMinDepth) || !(in_eye.z() > kMinDepth)) return std::nullopt;
  return Distort(rig_.Of(eye).camera, in_eye.hnormalized());
}

std::optional<FrameProjection::Linearised> FrameProjection::Linearise(
    Eye eye, const Eigen::Vector3d& x) const {
  const Eigen::Vector3d turned = turn_ * x;
  const Eigen::Vector3d in_left = turned + translation_;
  const Eigen::Vector3d in_eye =
      eye == Eye::kLeft ? in_left
                        : Eigen::Vector3d(right_turn_ * in_left + rig_.right_from_left.translation);
  if (!(in_left.z() > kMinDepth) || !(in_eye.z() > kMinDepth)) return std::nullopt;
  Linearised result;
  Eigen::Matrix2d distortion;
  const double inverse_depth = 1.0 / in_eye.z();
  const Eigen::Vector2d normalised = inverse_depth * in_eye.head<2>();
  result.pixel = Distort(rig_.Of(eye).camera, normalised, distortion);
  Eigen::Matrix<double, 2, 3> by_left;
  by_left.leftCols<2>() = inverse_depth * distortion;
  by_left.col(2) = -by_left.leftCols<2>() * normalised;
  if (eye == Eye::kRight) by_left *= right_turn_;
  for (int row = 0; row < 2; ++row) {
    result.by_pose.row(row).head<3>() = turned.cross(by_left.row(row).transpose());
  }
  result.by_pose.rightCols<3>() = by_left;
  result.by_point = by_left * turn_;
  return result;
}

}  // namespace rigmap
