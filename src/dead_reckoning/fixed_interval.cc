#include "dead_reckoning/internal/fixed_interval.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/statistics.h"

namespace rigmap {
namespace {

// a * inverse(b) of a covariance whose entries have very different units.
Eigen::MatrixXd RightDivided(const Eigen::MatrixXd& a, const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd correlations = scale.asDiagonal() * covariance * scale.asDiagonal();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * a.transpose();
  return (scale.asDiagonal() * correlations.ldlt().solve(scaled)).transpose();
}

Eigen::MatrixXd Symmetric(const Eigen::MatrixXd& matrix) {
  return 0.5 * (matrix + matrix.transpose());
}

Eigen::MatrixXd InnovationCovariance(const Belief& belief, const Measurement& measurement) {
  return Symmetric(measurement.jacobian * belief.covariance * measurement.jacobian.transpose() +
                   measurement.noise);
}

}  // namespace

Belief Corrected(const Belief& belief, const Eigen::VectorXd& error) {
  Belief corrected = belief;
  corrected.rover = Corrected(belief.rover, StateVector(error.head<kStateSize>()));
  for (std::size_t i = 0; i < belief.clones.size(); ++i) {
    const auto first = kStateSize + 6 * static_cast<Eigen::Index>(i);
    corrected.clones[i].gauge_from_left =
        Corrected(belief.clones[i].gauge_from_left, Vector6d(error.segment<6>(first)));
  }
  return corrected;
}

Eigen::VectorXd ErrorBetween(const Belief& a, const Belief& b) {
  Eigen::VectorXd error(b.Size());
  error.head<kStateSize>() = ErrorBetween(a.rover, b.rover);
  for (std::size_t i = 0; i < b.clones.size(); ++i) {
    error.segment<6>(kStateSize + 6 * static_cast<Eigen::Index>(i)) =
        ErrorBetween(a.clones[i].gauge_from_left, b.clones[i].gauge_from_left);
  }
  return error;
}

double InnovationSigmas(const Belief& belief, const Measurement& measurement) {
  const Eigen::VectorXd& residual = measurement.residual;
  const Eigen::MatrixXd solved =
      RightDivided(residual.transpose(), InnovationCovariance(belief, measurement));
  return RootOfSquares((solved * residual)(0, 0) / static_cast<double>(residual.size()));
}

Belief Updated(const Belief& belief, const Measurement& measurement) {
  const Eigen::MatrixXd& jacobian = measurement.jacobian;
  const Eigen::MatrixXd gain = RightDivided(belief.covariance * jacobian.transpose(),
                                            InnovationCovariance(belief, measurement));
  Belief updated = Corrected(belief, gain * measurement.residual);
  // Joseph's form, which stays positive.
  const Eigen::MatrixXd rest =
      Eigen::MatrixXd::Identity(belief.Size(), belief.Size()) - gain * jacobian;
  updated.covariance = Symmetric(rest * belief.covariance * rest.transpose() +
                                 gain * measurement.noise * gain.transpose());
  return updated;
}

Advance Advanced(const Belief& belief, int frame, const std::vector<int>& kept,
                 const Prediction& prediction) {
  Advance advance;
  Belief& next = advance.predicted;
  next.rover = prediction.state;
  std::vector<Eigen::Index> from;  // where the clones' errors were
  for (std::size_t i = 0; i < belief.clones.size(); ++i) {
    if (std::ranges::find(kept, belief.clones[i].frame) == kept.end()) continue;
    next.clones.push_back(belief.clones[i]);
    from.push_back(kStateSize + 6 * static_cast<Eigen::Index>(i));
  }
  if (std::ranges::find(kept, frame) != kept.end()) {
    next.clones.push_back({frame, belief.rover.gauge_from_left});
    from.push_back(kPosition);
  }
  Eigen::MatrixXd& transition = advance.transition;
  transition.setZero(next.Size(), belief.Size());
  transition.topLeftCorner<kStateSize, kStateSize>() = prediction.transition;
  for (std::size_t i = 0; i < from.size(); ++i) {
    transition.block<6, 6>(kStateSize + 6 * static_cast<Eigen::Index>(i), from[i]).setIdentity();
  }
  next.covariance = transition * belief.covariance * transition.transpose();
  next.covariance.topLeftCorner<kStateSize, kStateSize>() += prediction.noise;
  next.covariance = Symmetric(next.covariance);
  return advance;
}

std::vector<Belief> Smoothed(const std::vector<Belief>& filtered,
                             const std::vector<Advance>& advances) {
  std::vector<Belief> smoothed = filtered;
  for (std::size_t k = advances.size(); k-- > 0;) {
    const auto& [predicted, transition] = advances[k];
    const Belief& after = smoothed[k + 1];
    const Eigen::MatrixXd gain =
        RightDivided(filtered[k].covariance * transition.transpose(), predicted.covariance);
    smoothed[k] = Corrected(filtered[k], gain * ErrorBetween(after, predicted));
    smoothed[k].covariance =
        Symmetric(filtered[k].covariance +
                  gain * (after.covariance - predicted.covariance) * gain.transpose());
  }
  return smoothed;
}

}  // namespace rigmap
