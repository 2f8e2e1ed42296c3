#include "geometry/camera.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

namespace rigmap {
namespace {

// 1 + k1 r^2 + k2 r^4 + k3 r^6.
double RadialFactor(const Camera& camera, double r2) {
  return 1.0 + r2 * (camera.k1 + r2 * (camera.k2 + r2 * camera.k3));
}

// d(r RadialFactor) / dr.
double RadialGrowth(const Camera& camera, double r2) {
  return 1.0 + r2 * (3.0 * camera.k1 + r2 * (5.0 * camera.k2 + r2 * 7.0 * camera.k3));
}

// Where the growth is least or largest: up to two values of r^2.
std::array<double, 2> ExtremesOfGrowth(const Camera& camera) {
  // 3 k1 + 10 k2 r^2 + 21 k3 r^4 = 0, by the root that does not cancel (Numerical Recipes, 5.6).
  const double a = 21.0 * camera.k3, b = 10.0 * camera.k2, c = 3.0 * camera.k1;
  const double discriminant = b * b - 4.0 * a * c;
  if (discriminant < 0.0) return {0.0, 0.0};
  const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
  return {a == 0.0 ? 0.0 : q / a, q == 0.0 ? 0.0 : c / q};
}

}  // namespace

bool IsInsideFold(const Camera& camera, const Eigen::Vector2d& normalised) {
  const double r2 = normalised.squaredNorm();
  // The growth is 1 on the axis, so it is positive all the way if it is at its least.
  return RadialGrowth(camera, r2) > 0.0 &&
         std::ranges::all_of(ExtremesOfGrowth(camera), [&](double at) {
           return at <= 0.0 || at >= r2 || RadialGrowth(camera, at) > 0.0;
         });
}

Eigen::Vector2d Distort(const Camera& camera, const Eigen::Vector2d& normalised) {
  const double x = normalised.x(), y = normalised.y();
  const double r2 = x * x + y * y;
  const double radial = RadialFactor(camera, r2);
  const double xd = x * radial + 2.0 * camera.p1 * x * y + camera.p2 * (r2 + 2.0 * x * x);
  const double yd = y * radial + camera.p1 * (r2 + 2.0 * y * y) + 2.0 * camera.p2 * x * y;
  return {camera.fx * xd + camera.cx, camera.fy * yd + camera.cy};
}

Eigen::Vector2d Distort(const Camera& camera, const Eigen::Vector2d& normalised,
                        Eigen::Matrix2d& jacobian) {
  const double x = normalised.x(), y = normalised.y();
  const double r2 = x * x + y * y;
  const double radial = RadialFactor(camera, r2);
  // d radial / d x = slope * x
  const double slope = 2.0 * (camera.k1 + r2 * (2.0 * camera.k2 + r2 * 3.0 * camera.k3));
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
