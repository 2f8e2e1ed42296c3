#include "geometry/triangulation.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

namespace rigmap {
namespace {

// Point nearest to all rays; nothing where they are parallel to within 1e-7 rad.
std::optional<Eigen::Vector3d> NearestToRays(std::span<const View> views) {
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (const View& view : views) {
    const Rigid3 world_from_camera = view.camera_from_world.Inverse();
    const Eigen::Vector3d ray =
        (world_from_camera.rotation * view.normalised.homogeneous()).normalized();
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - ray * ray.transpose();
    a += across;
    b += across * world_from_camera.translation;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(a);
  if (!(eigen.eigenvalues()(0) > 1e-14 * static_cast<double>(views.size()))) return std::nullopt;
  return Eigen::Vector3d(eigen.eigenvectors() * eigen.eigenvalues().cwiseInverse().asDiagonal() *
                         eigen.eigenvectors().transpose() * b);
}

bool InFrontOfAll(std::span<const View> views, const Eigen::Vector3d& x) {
  return std::all_of(views.begin(), views.end(),
                     [&](const View& view) { return (view.camera_from_world * x).z() > 0.0; });
}

// One Gauss-Newton step on the normalised reprojection error.
Eigen::Vector3d Step(std::span<const View> views, const Eigen::Vector3d& x) {
  Eigen::Matrix3d h = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  for (const View& view : views) {
    const Eigen::Vector3d p = view.camera_from_world * x;
    Eigen::Matrix<double, 2, 3> j;
    j << 1.0 / p.z(), 0.0, -p.x() / (p.z() * p.z()), 0.0, 1.0 / p.z(), -p.y() / (p.z() * p.z());
    j = j * view.camera_from_world.rotation.toRotationMatrix();
    h += j.transpose() * j;
    g += j.transpose() * (p.hnormalized() - view.normalised);
  }
  return h.ldlt().solve(g);
}

}  // namespace

std::optional<Eigen::Vector3d> Triangulate(std::span<const View> views) {
  std::optional<Eigen::Vector3d> x = NearestToRays(views);
  if (!x || !InFrontOfAll(views, *x)) return std::nullopt;
  constexpr int kMaxIterations = 5;
  for (int i = 0; i < kMaxIterations; ++i) {
    const Eigen::Vector3d step = Step(views, *x);
    const Eigen::Vector3d moved = *x - step;
    if (!moved.allFinite() || !InFrontOfAll(views, moved)) break;
    x = moved;
    if (step.norm() < 1e-9 * moved.norm()) break;
  }
  return x;
}

std::optional<Eigen::Vector3d> TriangulateStereo(const Rigid3& right_from_left,
                                                 const Eigen::Vector2d& left_normalised,
                                                 const Eigen::Vector2d& right_normalised) {
  const std::array<View, 2> views{View{Rigid3(), left_normalised},
                                  View{right_from_left, right_normalised}};
  return Triangulate(views);
}

}  // namespace rigmap
