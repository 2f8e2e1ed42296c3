// Planes laid through measured points, by least squares.
#pragma once

#include <Eigen/Core>

namespace rigmap {

// value = plane . (x, y, 1): slope along x, slope along y, value at the origin. Errors are taken
// along the value only, so the plane must not be steep in it. Cost of Add: a few nanoseconds.
class PlaneFit {
 public:
  // `prior_information`: of each coefficient about zero, in units of full weights; without any,
  // three places that are not on one line are needed.
  explicit PlaneFit(const Eigen::Vector3d& prior_information = Eigen::Vector3d::Zero())
      : normal_matrix_(prior_information.asDiagonal()) {}

  void Add(double x, double y, double value, double weight = 1.0) {
    const Eigen::Vector3d regressor(x, y, 1.0);
    normal_matrix_.noalias() += weight * regressor * regressor.transpose();
    right_side_ += weight * value * regressor;
  }

  // Not finite where the places do not determine it.
  Eigen::Vector3d Solve() const;

 private:
  Eigen::Matrix3d normal_matrix_;
  Eigen::Vector3d right_side_ = Eigen::Vector3d::Zero();
};

}  // namespace rigmap
