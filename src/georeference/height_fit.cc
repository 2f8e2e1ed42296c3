#include "georeference/internal/height_fit.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/statistics.h"

namespace rigmap {
namespace {

constexpr double kMaxHeightSigmas = 4.0;  // normal noise goes beyond once in 16 000 fixes
constexpr double kMadToSigma = 1.4826;

std::vector<HeightPair> WithoutOutliers(std::span<const HeightPair> pairs) {
  std::vector<double> rises_m;
  for (const HeightPair& pair : pairs) rises_m.push_back(pair.rise_m);
  const double median_m = Median(rises_m);
  for (double& rise_m : rises_m) rise_m = std::abs(rise_m - median_m);
  const double scatter_m = kMadToSigma * Median(rises_m);
  std::vector<HeightPair> used;
  std::ranges::copy_if(pairs, std::back_inserter(used), [&](const HeightPair& pair) {
    return std::abs(pair.rise_m - median_m) <= kMaxHeightSigmas * std::max(pair.sigma_m, scatter_m);
  });
  return used;
}

// By how much a mean of them is less certain than if each erred by itself: a receiver's height
// wanders over minutes, so that fixes one after the other say nearly the same (a first-order
// autoregression).
double InflationByNeighbours(const HeightFit& fit) {
  constexpr double kMostAlike = 0.95;
  double products = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < fit.used.size(); ++i) {
    const double residual_m = fit.used[i].rise_m - fit.rise_m;
    squares += residual_m * residual_m;
    if (i > 0) products += residual_m * (fit.used[i - 1].rise_m - fit.rise_m);
  }
  if (!(squares > 0.0)) return 1.0;
  const double alike = std::clamp(products / squares, 0.0, kMostAlike);
  return std::sqrt((1.0 + alike) / (1.0 - alike));
}

// The rises as a plane over the path's own axes; nothing where they do not determine it.
void CheckTilt(HeightFit& fit) {
  const auto count = static_cast<double>(fit.used.size());
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const HeightPair& pair : fit.used) middle += pair.x_in_world / count;
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  for (const HeightPair& pair : fit.used) {
    const Eigen::Vector2d arm = pair.x_in_world - middle;
    scatter += arm * arm.transpose() / count;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(scatter);
  Eigen::Vector2d along = axes.eigenvectors().col(1);
  if (along.dot(fit.used.back().x_in_world - fit.used.front().x_in_world) < 0.0) along = -along;
  const Eigen::Vector2d to_left(-along.y(), along.x());
  fit.length_m = 4.0 * std::sqrt(std::max(0.0, axes.eigenvalues()(1)));
  fit.width_m = 4.0 * std::sqrt(std::max(0.0, axes.eigenvalues()(0)));
  if (fit.used.size() < 4) return;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right_side = Eigen::Vector3d::Zero();
  const auto regressor = [&](const HeightPair& pair) -> Eigen::Vector3d {
    const Eigen::Vector2d arm = pair.x_in_world - middle;
    return Eigen::Vector3d(arm.dot(along), arm.dot(to_left), 1.0) / pair.sigma_m;
  };
  for (const HeightPair& pair : fit.used) {
    information += regressor(pair) * regressor(pair).transpose();
    right_side += regressor(pair) * pair.rise_m / pair.sigma_m;
  }
  const Eigen::Matrix3d covariance = information.inverse();
  if (!covariance.allFinite()) return;
  const Eigen::Vector3d plane = covariance * right_side;
  double chi2 = 0.0;
  for (const HeightPair& pair : fit.used) {
    chi2 += std::pow(pair.rise_m / pair.sigma_m - regressor(pair).dot(plane), 2.0);
  }
  const double inflation = std::sqrt(std::max(1.0, chi2 / (count - 3.0)));
  const auto check = [&](int i) {
    return TiltCheck{std::atan(plane(i)), inflation * std::sqrt(covariance(i, i))};
  };
  fit.along = check(0);
  fit.across = check(1);
}

}  // namespace

HeightFit FitHeight(std::span<const HeightPair> pairs) {
  HeightFit fit;
  fit.used = WithoutOutliers(pairs);
  double weights = 0.0, sum = 0.0;
  for (const HeightPair& pair : fit.used) {
    const double weight = 1.0 / (pair.sigma_m * pair.sigma_m);
    weights += weight;
    sum += weight * pair.rise_m;
  }
  fit.rise_m = sum / weights;
  double chi2 = 0.0, squares = 0.0;
  for (const HeightPair& pair : fit.used) {
    const double residual_m = pair.rise_m - fit.rise_m;
    chi2 += residual_m * residual_m / (pair.sigma_m * pair.sigma_m);
    squares += residual_m * residual_m;
  }
  const auto count = static_cast<double>(fit.used.size());
  fit.rms_m = std::sqrt(squares / count);
  fit.sigma_m = InflationByNeighbours(fit) *
                std::sqrt(std::max(1.0, chi2 / std::max(1.0, count - 1.0)) / weights);
  CheckTilt(fit);
  return fit;
}

}  // namespace rigmap
