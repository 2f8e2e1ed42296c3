// What is taken away from other unknowns when the position of a point is eliminated.
#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace rigmap {

// The inverse of a point's information, symmetric 3 x 3; the pseudo-inverse where rays do not tell
// all of its position: of one image, or of images between which it is as good as infinitely far.
// What its observations say of all else is then what they say whatever the point does.
inline Eigen::Matrix3d InverseOfPoint(const Eigen::Matrix3d& information) {
  // Beyond, what is left of differences of large terms is rounding. It is 30 000 baselines.
  constexpr double kMostCondition = 1e9;
  const Eigen::Matrix3d inverse = information.inverse();
  if (inverse.allFinite() && information.norm() * inverse.norm() < kMostCondition) return inverse;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(information);
  const Eigen::Vector3d values = solver.eigenvalues();
  Eigen::Matrix3d pseudo_inverse = Eigen::Matrix3d::Zero();
  for (int i = 0; i < 3; ++i) {
    if (!(values(i) * kMostCondition > values(2))) continue;
    pseudo_inverse +=
        solver.eigenvectors().col(i) * solver.eigenvectors().col(i).transpose() / values(i);
  }
  return pseudo_inverse;
}

}  // namespace rigmap
