#include "evaluation/rock_deformation.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

namespace rigmap {
namespace {

constexpr double kHuber_m = 0.01;  // the noise of a map that is good: beyond, weights fall
constexpr int kRounds = 5;         // weights change in the fourth digit from then on
// Neighbouring points were measured from the same windows of the images: so many count as one.
constexpr double kPointsPerObservation = 25.0;
constexpr double kLeastResidual_m = 1e-9;
constexpr double kPseudoInverseRank = 1e-15;  // of the largest singular value

// The solution of least length, as the system may be short of rank.
Eigen::VectorXd LeastSquares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  Eigen::JacobiSVD<Eigen::MatrixXd> svd(a, Eigen::ComputeThinU | Eigen::ComputeThinV);
  svd.setThreshold(std::numeric_limits<double>::epsilon() * static_cast<double>(a.rows()));
  return svd.solve(b);
}

Eigen::MatrixXd PseudoInverse(const Eigen::MatrixXd& square) {
  Eigen::JacobiSVD<Eigen::MatrixXd> svd(square, Eigen::ComputeThinU | Eigen::ComputeThinV);
  svd.setThreshold(kPseudoInverseRank);
  return svd.solve(Eigen::MatrixXd::Identity(square.rows(), square.cols()));
}

// Residual = design * (translation, stretch - 1) - distance.
struct Equations {
  Eigen::MatrixXd design;    // n x 6
  Eigen::VectorXd distance;  // n; of the mapped points from the planes, m
};

Equations BuildEquations(std::span<const RockMatch> matches, const Eigen::Vector3d& centre,
                         const Eigen::Matrix3d& axes) {
  const auto count = static_cast<Eigen::Index>(matches.size());
  Equations equations{Eigen::MatrixXd(count, 6), Eigen::VectorXd(count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const RockMatch& match = matches[i];
    const Eigen::Vector3d arm_m = axes * (match.x_true - centre);
    equations.design.row(i) << match.normal.transpose(),
        (axes * match.normal).cwiseProduct(arm_m).transpose();
    equations.distance(i) = (match.x_mapped - match.x_true).dot(match.normal);
  }
  return equations;
}

// Square roots of Huber's weights.
Eigen::VectorXd RootWeights(const Eigen::VectorXd& residual_m) {
  return residual_m.unaryExpr([](double r) {
    return std::sqrt(std::min(1.0, kHuber_m / std::max(std::abs(r), kLeastResidual_m)));
  });
}

}  // namespace

RockDeformation FitDeformation(std::span<const RockMatch> matches, const Eigen::Vector3d& centre,
                               const Eigen::Matrix3d& axes) {
  const auto [design, distance] = BuildEquations(matches, centre, axes);
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(distance.size()), solution;
  for (int round = 0; round < kRounds; ++round) {
    solution = LeastSquares(weights.asDiagonal() * design, weights.cwiseProduct(distance));
    weights = RootWeights(distance - design * solution);
  }
  const Eigen::MatrixXd weighted = weights.asDiagonal() * design;
  const double variance =
      weights.cwiseProduct(distance - design * solution).squaredNorm() / distance.size();
  const Eigen::MatrixXd covariance =
      PseudoInverse(weighted.transpose() * weighted) * variance * kPointsPerObservation;
  RockDeformation deformation;
  deformation.shift_m = LeastSquares(weighted.leftCols(3), weights.cwiseProduct(distance)).norm();
  deformation.stretch = solution.tail<3>().array() + 1.0;
  deformation.sigma_stretch = covariance.diagonal().tail<3>().cwiseMax(0.0).cwiseSqrt();
  return deformation;
}

}  // namespace rigmap
