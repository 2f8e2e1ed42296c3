#include "geometry/camera.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

namespace rigmap {
namespace {

// True for a ray nearer to the axis than where the radial distortion folds back: the first root of
// d(r (1 + k1 r^2 + k2 r^4)) / dr. Beyond it a pixel would be seen a second time.
bool IsInsideFold(const Camera& camera, const Eigen::Vector2d& normalised) {
  const double b = 3.0 * camera.k1;
  const double discriminant = b * b - 20.0 * camera.k2;
  if (discriminant < 0.0) return true;
  const double two_by_fold_r2 = -b + std::sqrt(discriminant);
  return normalised.squaredNorm() * two_by_fold_r2 < 2.0;
}

}  // namespace

Eigen::Vector2d Distort(const Camera& camera, const Eigen::Vector2d& normalised) {
  const double x = normalised.x(), y = normalised.y();
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (camera.k1 + r2 * camera.k2);
  const double xd = x * radial + 2.0 * camera.p1 * x * y + camera.p2 * (r2 + 2.0 * x * x);
  const double yd = y * radial + camera.p1 * (r2 + 2.0 * y * y) + 2.0 * camera.p2 * x * y;
  return {camera.fx * xd + camera.cx, camera.fy * yd + camera.cy};
}

Eigen::Vector2d Distort(const Camera& camera, const Eigen::Vector2d& normalised,
                        Eigen::Matrix2d& jacobian) {
  const double x = normalised.x(), y = normalised.y();
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (camera.k1 + r2 * camera.k2);
  const double slope = 2.0 * (camera.k1 + 2.0 * r2 * camera.k2);  // d radial / d x = slope * x
  const double xy = x * y * slope + 2.0 * (camera.p1 * x + camera.p2 * y);
  jacobian(0, 0) = camera.fx * (radial + x * x * slope + 2.0 * camera.p1 * y + 6.0 * camera.p2 * x);
  jacobian(0, 1) = camera.fx * xy;
  jacobian(1, 0) = camera.fy * xy;
  jacobian(1, 1) = camera.fy * (radial + y * y * slope + 6.0 * camera.p1 * y + 2.0 * camera.p2 * x);
  return Distort(camera, normalised);
}

std::optional<Eigen::Vector2d> Undistort(const Camera& camera, const Eigen::Vector2d& pixel) {
  Eigen::Vector2d normalised((pixel.x() - camera.cx) / camera.fx,
                             (pixel.y() - camera.cy) / camera.fy);
  if (camera.IsPinhole()) return normalised;
  constexpr int kMaxIterations = 30;
  for (int i = 0; i < kMaxIterations; ++i) {
    Eigen::Matrix2d jacobian;
    const Eigen::Vector2d residual = Distort(camera, normalised, jacobian) - pixel;
    if (!(jacobian.determinant() > 0.0)) return std::nullopt;  // beyond the fold
    const Eigen::Vector2d step = jacobian.inverse() * residual;
    normalised -= step;
    if (step.squaredNorm() < 1e-20) {
      return IsInsideFold(camera, normalised) ? std::make_optional(normalised) : std::nullopt;
    }
  }
  return std::nullopt;
}

std::optional<Eigen::Vector2d> Project(const Camera& camera, const Eigen::Vector3d& x_in_camera) {
  constexpr double kMinDepth = 1e-9;
  if (!(x_in_camera.z() > kMinDepth)) return std::nullopt;
  const Eigen::Vector2d normalised = x_in_camera.hnormalized();
  if (!IsInsideFold(camera, normalised)) return std::nullopt;
  return Distort(camera, normalised);
}

}  // namespace rigmap
