#include "raster/slope_statistics.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace rigmap {
namespace {

// Below this share of the limit a sigma is taken for this: the step it stands for is as sharp.
constexpr double kLeastSigma = 1e-6;
constexpr double kFarSigmas = 6.0;  // beyond lies 2e-9

double NormalCdf(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

}  // namespace

// P(inside) = integral over u of phi((u - m1) / s1) / s1 [Phi((h - m2) / s2) - Phi((-h - m2) / s2)]
// with h = sqrt(t^2 - u^2), in the covariance's own axes, the wider along u.
double ProbabilityOfSteeper(const Eigen::Vector2d& gradient, const Eigen::Matrix2d& covariance,
                            double limit_rad) {
  const double limit = std::tan(limit_rad);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(covariance);
  const Eigen::Vector2d sigma =
      axes.eigenvalues().cwiseMax(0.0).cwiseSqrt().cwiseMax(kLeastSigma * limit);
  const Eigen::Vector2d mean = axes.eigenvectors().transpose() * gradient;
  const double away = gradient.norm() - limit;
  if (away > kFarSigmas * sigma(1)) return 1.0;
  if (away < -kFarSigmas * sigma(1)) return 0.0;
  const double from = std::max(-limit, mean(1) - kFarSigmas * sigma(1));
  const double to = std::min(limit, mean(1) + kFarSigmas * sigma(1));
  if (from >= to) return 1.0;
  // u = limit sin(a): smooth where the circle's edge is vertical. Simpson's rule.
  constexpr int kSteps = 128;
  const double first_rad = std::asin(from / limit), last_rad = std::asin(to / limit);
  const double step_rad = (last_rad - first_rad) / kSteps;
  double inside = 0.0;
  for (int i = 0; i <= kSteps; ++i) {
    const double angle_rad = first_rad + i * step_rad;
    const double u = limit * std::sin(angle_rad), half = limit * std::cos(angle_rad);
    const double z = (u - mean(1)) / sigma(1);
    const double density = std::exp(-0.5 * z * z) / (sigma(1) * std::sqrt(2.0 * std::numbers::pi));
    const double across =
        NormalCdf((half - mean(0)) / sigma(0)) - NormalCdf((-half - mean(0)) / sigma(0));
    const double weight = i == 0 || i == kSteps ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
    inside += weight * density * across * half;
  }
  return std::clamp(1.0 - inside * step_rad / 3.0, 0.0, 1.0);
}

}  // namespace rigmap
