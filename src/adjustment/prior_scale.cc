#include "adjustment/internal/prior_scale.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <limits>

namespace rigmap {

double PriorScale(const CalibrationVector& now, const CalibrationEquations& equations,
                  double inflation, const CalibrationPrior& prior) {
  // In units in which the prior is a unit sphere, along the axes of what the part knows: the part
  // tells of the i-th coordinate with the information known(i), its weighted value being said(i).
  const CalibrationMatrix root = prior.information.inverse().llt().matrixL();
  const Eigen::SelfAdjointEigenSolver<CalibrationMatrix> part(
      root.transpose() * (equations.information / inflation) * root);
  if (part.info() != Eigen::Success || !part.eigenvalues().allFinite()) return 1.0;
  const CalibrationVector known = part.eigenvalues().cwiseMax(0.0);
  const CalibrationVector said = part.eigenvectors().transpose() * root.transpose() *
                                 (equations.information * now + equations.score) / inflation;
  const auto minus_log_probability = [&](double scale) {
    const double variance = scale * scale;
    double sum = std::log(variance) + 1.0 / variance;
    for (int i = 0; i < kCalibrationSize; ++i) {
      if (!(known(i) > 0.0)) continue;
      const double of_both = known(i) * variance + 1.0;
      sum += std::log(of_both) + said(i) * said(i) / (known(i) * of_both);
    }
    return sum;
  };
  constexpr double kLargest = 20.0, kStep = 1.02;
  const double step = prior.is_stated ? kStep : 1.0 / kStep;
  double best = 1.0, least = std::numeric_limits<double>::infinity();
  for (double scale = 1.0; scale <= kLargest && scale >= 1.0 / kLargest; scale *= step) {
    const double cost = minus_log_probability(scale);
    if (!(cost < least)) continue;
    least = cost;
    best = scale;
  }
  return best;
}

}  // namespace rigmap
