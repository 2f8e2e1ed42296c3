#include "dead_reckoning/internal/wheel_agreement.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace rigmap {
namespace {

constexpr std::size_t kWheels = 6;
using Shares = Eigen::Matrix<double, kWheels, 1>;

// Of the way to a frame: how far each wheel turned, over the mean of all, and its curve.
struct Roll {
  Shares shares = Shares::Zero();
  Eigen::Vector3d curve = Eigen::Vector3d::Zero();  // 1, 1/m, 1/m^2: powers of the curvature

  double Curvature() const { return curve.y(); }
};

std::optional<Shares> AnglesAt(const std::vector<WheelSample>& samples, StampNs stamp_ns) {
  const auto after = std::ranges::lower_bound(samples, stamp_ns, {}, &WheelSample::stamp_ns);
  if (after == samples.end() || (after == samples.begin() && after->stamp_ns != stamp_ns)) {
    return std::nullopt;
  }
  const auto before = after == samples.begin() ? after : after - 1;
  const double share = after == before
                           ? 0.0
                           : static_cast<double>(stamp_ns - before->stamp_ns) /
                                 static_cast<double>(after->stamp_ns - before->stamp_ns);
  Shares angles;
  for (std::size_t k = 0; k < kWheels; ++k) {
    const double from = before->drive_angle_rad[k], to = after->drive_angle_rad[k];
    angles(static_cast<Eigen::Index>(k)) = from + share * (to - from);
  }
  return angles;
}

// Nothing where the rover hardly drove, or a wheel turned backwards.
std::optional<Roll> RollTo(std::size_t frame, const Dataset& dataset,
                           const EstimatedMotion& motion) {
  constexpr double kLeastWay_m = 0.05;
  const auto before = AnglesAt(dataset.wheels.samples, dataset.frames[frame - 1].stamp_ns),
             after = AnglesAt(dataset.wheels.samples, dataset.frames[frame].stamp_ns);
  if (!before || !after) return std::nullopt;
  const Shares turned = *after - *before;
  const Rigid3 step =
      motion.poses[frame - 1].gauge_from_left.Inverse() * motion.poses[frame].gauge_from_left;
  const double way_m = step.translation.norm();
  if (way_m < kLeastWay_m || !(std::abs(turned.mean()) > 0.0) ||
      (turned.array() * turned.mean() <= 0.0).any()) {
    return std::nullopt;
  }
  const double curvature = LogRotation(step.rotation).y() / way_m;  // about the camera's y, down
  return Roll{turned / turned.mean(), {1.0, curvature, curvature * curvature}};
}

// Shares by the curve: least squares drawn to wheels that all turn alike, with the scatter that the
// rolls have about it.
class Model {
 public:
  explicit Model(const std::vector<Roll>& rolls) {
    for (const Roll& roll : rolls) {
      least_curvature_ = std::min(least_curvature_, roll.Curvature());
      most_curvature_ = std::max(most_curvature_, roll.Curvature());
    }
    // What wheels may differ by; per m of a curve's 1/radius, likewise of its square.
    const Eigen::Vector3d prior(0.1, 0.5, 0.5);
    for (int round = 0; round < 2; ++round) {
      Eigen::Matrix3d information = prior.cwiseAbs2().cwiseInverse().asDiagonal();
      Eigen::Matrix<double, 3, kWheels> score = Eigen::Matrix<double, 3, kWheels>::Zero();
      for (const Roll& roll : rolls) {
        information += roll.curve * roll.curve.transpose() / variance_;
        score += roll.curve * (roll.shares - Shares::Ones()).transpose() / variance_;
      }
      covariance_ = information.inverse();
      by_curve_ = covariance_ * score;
      double squares = kAsExpected * kWheels * kExpected * kExpected;
      for (const Roll& roll : rolls) squares += Off(roll).squaredNorm();
      variance_ = squares / (kWheels * (kAsExpected + static_cast<double>(rolls.size())));
    }
  }

  // Whether rolls were driven in such a curve, nearly: beyond them powers of it tell nothing.
  bool Knows(const Roll& roll) const {
    constexpr double kNearly_per_m = 0.05;
    return roll.Curvature() > least_curvature_ - kNearly_per_m &&
           roll.Curvature() < most_curvature_ + kNearly_per_m;
  }

  // Root mean square over the wheels, in sigmas.
  double OffSigmas(const Roll& roll) const {
    const double variance = variance_ + roll.curve.dot(covariance_ * roll.curve);
    return std::sqrt(Off(roll).squaredNorm() / kWheels / variance);
  }

 private:
  static constexpr double kExpected = 0.01, kAsExpected = 2.0;  // scatter; rolls that have it

  Shares Off(const Roll& roll) const {
    return roll.shares - Shares::Ones() - by_curve_.transpose() * roll.curve;
  }

  double least_curvature_ = 0.0, most_curvature_ = 0.0;  // 1/m
  double variance_ = kExpected * kExpected;
  Eigen::Matrix3d covariance_;
  Eigen::Matrix<double, 3, kWheels> by_curve_;
};

}  // namespace

std::vector<int> FramesOfUnlikeWheels(const Dataset& dataset, const EstimatedMotion& motion,
                                      const std::vector<bool>& checked,
                                      const std::vector<bool>& asked) {
  constexpr double kMostSigmas = 3.0;
  std::vector<Roll> rolls;
  for (std::size_t i = 1; i < checked.size(); ++i) {
    if (!checked[i]) continue;
    if (const auto roll = RollTo(i, dataset, motion)) rolls.push_back(*roll);
  }
  const Model model(rolls);
  std::vector<int> found;
  for (std::size_t i = 1; i < asked.size(); ++i) {
    if (!asked[i]) continue;
    const auto roll = RollTo(i, dataset, motion);
    if (roll && model.Knows(*roll) && model.OffSigmas(*roll) > kMostSigmas)
      found.push_back(static_cast<int>(i));
  }
  return found;
}

}  // namespace rigmap
