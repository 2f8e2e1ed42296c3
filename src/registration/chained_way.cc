#include "registration/internal/chained_way.h"

#include "geometry/adjoint.h"

namespace rigmap {

std::optional<Matrix6d> CovarianceBetween(const Odometry& chain, int earlier, int later) {
  const Rigid3 later_from_world = chain[later].world_from_left.Inverse();
  Matrix6d sum = Matrix6d::Zero();
  for (int a = earlier, b = later; a != b;) {
    int& end = a > b ? a : b;
    const Matrix6d carry = Adjoint(later_from_world * chain[end].world_from_left);
    sum += carry * chain[end].step_covariance * carry.transpose();
    if (chain[end].reference >= end) return std::nullopt;
    end = chain[end].reference;
  }
  return sum;
}

}  // namespace rigmap
