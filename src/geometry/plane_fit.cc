#include "geometry/plane_fit.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace rigmap {

Eigen::Vector3d PlaneFit::Solve() const { return normal_matrix_.inverse() * right_side_; }

Eigen::Vector3d PlaneNormal(std::span<const Eigen::Vector3d> points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& x : points) mean += x / static_cast<double>(points.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const auto& x : points) scatter += (x - mean) * (x - mean).transpose();
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors().col(0);
}

}  // namespace rigmap
