#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "adjustment/calibration.h"

namespace rigmap {
namespace {

// By how many times as much blocks differ (variance) as independent observations would have it: of
// what each says of single parameters, the geometric mean, so that one parameter in which a lens is
// unlike its model does not stand for all. No bound where there are fewer blocks than a whole part
// has, too few to tell whether they agree, or where they are singular.
double ScatterOf(const std::vector<CalibrationBlock>& blocks) {
  constexpr double kUnknown = std::numeric_limits<double>::infinity();
  constexpr std::size_t kWhole = 8;
  if (blocks.size() < kWhole) return kUnknown;
  CalibrationBlock sum;
  for (const CalibrationBlock& block : blocks) sum += block;
  const CalibrationMatrix covariance =
      sum.information.ldlt().solve(CalibrationMatrix::Identity()).eval();
  const CalibrationVector step = covariance * sum.score;
  CalibrationMatrix found = CalibrationMatrix::Zero(), expected = sum.information;
  for (const CalibrationBlock& block : blocks) {
    const CalibrationVector score = block.score - block.information * step;
    found += score * score.transpose();
    expected -= block.information * covariance * block.information;
  }
  const auto variances = [&](const CalibrationMatrix& of_score) -> Eigen::ArrayXd {
    return (covariance * of_score * covariance).diagonal().array();
  };
  const double scatter = std::exp((variances(found) / variances(expected)).log().mean());
  return std::isfinite(scatter) ? scatter : kUnknown;
}

double OfTracks(const CalibrationEquations& equations) {
  const CalibrationMatrix ratio = equations.information.ldlt().solve(equations.score_covariance);
  const double mean = ratio.diagonal().mean();
  return std::isfinite(mean) ? std::max(1.0, mean) : 1.0;
}

}  // namespace

double InflationOfPoses(const CalibrationEquations& equations, const AdjustmentOptions& options) {
  return OfTracks(equations) * options.shared_noise * options.shared_noise;
}

double Inflation(const CalibrationEquations& equations, const AdjustmentOptions& options) {
  // Of what shared noise adds to the variance of a pose, where blocks do not contradict each other.
  // With it the squared errors of all parameters of the drawn rigs of simulated S-curves and drives
  // in glare are their variance.
  constexpr double kShare = 1.0 / 3.0;
  // What eight blocks scatter by may be so many times as large: the geometric mean of squares of
  // seven degrees of freedom is 0.86 of their mean, and chance makes a quarter of it.
  constexpr double kAtMost = 1.5;
  const double shared = kShare * (options.shared_noise * options.shared_noise - 1.0);
  const double scatter = std::max(ScatterOf(equations.stretches), ScatterOf(equations.regions));
  return std::max(OfTracks(equations) * (1.0 + shared) + shared * equations.coherent,
                  std::min(InflationOfPoses(equations, options), kAtMost * scatter));
}

}  // namespace rigmap
