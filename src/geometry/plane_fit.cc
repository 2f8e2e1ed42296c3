#include "geometry/plane_fit.h"

#include <Eigen/LU>

namespace rigmap {

Eigen::Vector3d PlaneFit::Solve() const { return normal_matrix_.inverse() * right_side_; }

}  // namespace rigmap
