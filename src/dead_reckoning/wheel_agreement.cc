#include "dead_reckoning/internal/wheel_agreement.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace rigmap {
namespace {

constexpr std::size_t kWheels = 6;
using Shares = Eigen::Matrix<double, kWheels, 1>;

// Of the way to a frame: how far each wheel turned, over the mean of all, and its curve.
struct Roll {
  Shares shares = Shares::Zero();
  Eigen::Vector3d curve = Eigen::Vector3d::Zero();  // 1, 1/m, 1/m^2: powers of the mean curvature
  double least_curvature = 0.0, most_curvature = 0.0;  // 1/m, of pieces of the way
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

// The sharpest curves either way, by the gyro, of pieces of the way between two stamps.
std::pair<double, double> CurvaturesBetween(StampNs begin_ns, StampNs end_ns,
                                            const Dataset& dataset, double wheel_radius_m) {
  constexpr double kPiece_m = 0.25;
  const auto& samples = dataset.inertial.samples;
  double least = 0.0, most = 0.0, turned_rad = 0.0;
  auto from = AnglesAt(dataset.wheels.samples, begin_ns);
  for (auto sample = std::ranges::upper_bound(samples, begin_ns, {}, &InertialSample::stamp_ns);
       from && sample != samples.end() && sample->stamp_ns <= end_ns; ++sample) {
    if (sample == samples.begin()) continue;
    const double step_s = 1e-9 * static_cast<double>(sample->stamp_ns - (sample - 1)->stamp_ns);
    // About the camera's y, which points down.
    turned_rad -=
        step_s * sample->angular_rate_radps.dot(sample->inclination_mps2.stableNormalized());
    const auto here = AnglesAt(dataset.wheels.samples, sample->stamp_ns);
    if (!here) break;
    const double way_m = wheel_radius_m * (*here - *from).mean();
    if (std::abs(way_m) < kPiece_m) continue;
    least = std::min(least, turned_rad / way_m);
    most = std::max(most, turned_rad / way_m);
    turned_rad = 0.0;
    from = here;
  }
  return {least, most};
}

// Nothing where the rover hardly drove, or a wheel turned backwards.
std::optional<Roll> RollTo(std::size_t frame, const Dataset& dataset, const EstimatedMotion& motion,
                           double wheel_radius_m) {
  constexpr double kLeastWay_m = 0.05;
  const auto before = AnglesAt(dataset.wheels.samples, dataset.frames[frame - 1].stamp_ns),
             after = AnglesAt(dataset.wheels.samples, dataset.frames[frame].stamp_ns);
  if (!before || !after) return std::nullopt;
  const Shares turned = *after - *before;
  const double mean = turned.mean();
  if (std::abs(mean) * wheel_radius_m < kLeastWay_m || (turned.array() * mean <= 0.0).any()) {
    return std::nullopt;
  }
  const Eigen::Quaterniond turn = motion.poses[frame - 1].gauge_from_left.rotation.conjugate() *
                                  motion.poses[frame].gauge_from_left.rotation;
  // About the camera's y, which points down; of the way along the curve.
  const double curvature = LogRotation(turn).y() / (mean * wheel_radius_m);
  const auto [least, most] = CurvaturesBetween(
      dataset.frames[frame - 1].stamp_ns, dataset.frames[frame].stamp_ns, dataset, wheel_radius_m);
  return Roll{turned / mean,
              {1.0, curvature, curvature * curvature},
              std::min(least, curvature),
              std::max(most, curvature)};
}

// Shares by the curve: least squares drawn to wheels that all turn alike, with the scatter that the
// rolls have about it.
class Model {
 public:
  explicit Model(const std::vector<Roll>& rolls) {
    for (const Roll& roll : rolls) {
      least_curvature_ = std::min(least_curvature_, roll.curve.y());
      most_curvature_ = std::max(most_curvature_, roll.curve.y());
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
    return roll.least_curvature > least_curvature_ - kNearly_per_m &&
           roll.most_curvature < most_curvature_ + kNearly_per_m;
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

WheelAgreement AgreementOfWheels(const Dataset& dataset, const EstimatedMotion& motion,
                                 const std::vector<bool>& checked, const std::vector<bool>& asked,
                                 double wheel_radius_m) {
  constexpr double kMostSigmas = 3.0;
  std::vector<Roll> rolls;
  for (std::size_t i = 1; i < checked.size(); ++i) {
    if (!checked[i]) continue;
    if (const auto roll = RollTo(i, dataset, motion, wheel_radius_m)) rolls.push_back(*roll);
  }
  const Model model(rolls);
  WheelAgreement found;
  for (std::size_t i = 1; i < asked.size(); ++i) {
    if (!asked[i]) continue;
    const auto roll = RollTo(i, dataset, motion, wheel_radius_m);
    if (!roll || !model.Knows(*roll)) continue;
    (model.OffSigmas(*roll) > kMostSigmas ? found.unlike : found.alike)
        .push_back(static_cast<int>(i));
  }
  return found;
}

}  // namespace rigmap
