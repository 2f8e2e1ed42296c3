#include "evaluation/internal/prism_fitter.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace rigmap {
namespace {

constexpr double kInlier_m = 0.05;  // beyond, a residual counts by its length, no longer its square
constexpr double kLeverWeight = 0.02, kClockWeight = 0.01;  // of the priors: per m, per s
constexpr int kHeadings = 8;
constexpr int kMaxSteps = 200;
constexpr double kEnoughInside = 0.75;  // of the poses inside where the clocks agree

// A residual whose square is twice (sqrt(1 + r^2) - 1), r in kInlier_m: least squares of these are
// those of the pseudo-Huber loss.
double Soften(double residual) {
  const double ratio = residual / kInlier_m, square = ratio * ratio;
  const double loss = 2.0 * square / (std::sqrt(1.0 + square) + 1.0);
  return std::copysign(kInlier_m * std::sqrt(loss), residual);
}

std::vector<double> SecondsSince(StampNs start_ns, std::span<const StampNs> stamps_ns) {
  std::vector<double> seconds;
  for (const StampNs stamp_ns : stamps_ns) {
    seconds.push_back(1e-9 * static_cast<double>(stamp_ns - start_ns));
  }
  return seconds;
}

template <typename Timed>
std::vector<StampNs> StampsOf(std::span<const Timed> items) {
  std::vector<StampNs> stamps_ns;
  for (const Timed& item : items) stamps_ns.push_back(item.stamp_ns);
  return stamps_ns;
}

}  // namespace

PrismFitter::PrismFitter(std::span<const TumPose> world_from_body,
                         std::span<const PrismPosition> track)
    : poses_(world_from_body),
      track_(track),
      times_s_(SecondsSince(track.front().stamp_ns, StampsOf(world_from_body))),
      track_times_s_(SecondsSince(track.front().stamp_ns, StampsOf(track))) {
  const auto inside = static_cast<double>(CountInside(PrismParameters::Zero()));
  enough_inside_ =
      std::max(kMinInside, static_cast<std::size_t>(std::ceil(kEnoughInside * inside)));
}

Eigen::Vector2d PrismFitter::TrackAt(double time_s, double clock_offset_s) const {
  const double at_s = time_s + clock_offset_s;
  const auto after = std::ranges::lower_bound(track_times_s_, at_s);
  if (after == track_times_s_.begin()) return track_.front().position;
  if (after == track_times_s_.end()) return track_.back().position;
  const auto i = static_cast<std::size_t>(after - track_times_s_.begin());
  const double share = (at_s - track_times_s_[i - 1]) / (*after - track_times_s_[i - 1]);
  return track_[i - 1].position + share * (track_[i].position - track_[i - 1].position);
}

Eigen::Vector2d PrismFitter::PrismOf(std::size_t pose, const PrismParameters& x) const {
  const Eigen::Vector3d prism_in_body = x.segment<3>(3);
  const Eigen::Vector3d prism = poses_[pose].world_from_body * prism_in_body;
  return Eigen::Rotation2Dd(x(0)) * Eigen::Vector2d(std::exp(x(7)) * prism.head<2>()) +
         x.segment<2>(1);
}

std::vector<Eigen::Vector3d> PrismFitter::Differences(const PrismParameters& x) const {
  std::vector<Eigen::Vector3d> differences(poses_.size(), Eigen::Vector3d::Zero());
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    const double at_s = times_s_[i] + x(6);
    if (at_s < track_times_s_.front() || at_s > track_times_s_.back()) continue;
    differences[i] << PrismOf(i, x) - TrackAt(times_s_[i], x(6)), 1.0;
  }
  return differences;
}

std::size_t PrismFitter::CountInside(const PrismParameters& x) const {
  return static_cast<std::size_t>(std::ranges::count_if(
      Differences(x), [](const Eigen::Vector3d& difference) { return difference.z() > 0.0; }));
}

Eigen::VectorXd PrismFitter::Residuals(const PrismParameters& x, double expected_offset_s) const {
  const auto differences = Differences(x);
  const auto count = static_cast<Eigen::Index>(differences.size());
  Eigen::VectorXd residuals(2 * count + 4);
  for (Eigen::Index i = 0; i < count; ++i) {
    residuals.segment<2>(2 * i) = differences[static_cast<std::size_t>(i)].head<2>();
  }
  residuals.segment<3>(2 * count) = kLeverWeight * x.segment<3>(3);
  residuals(2 * count + 3) = kClockWeight * (x(6) - expected_offset_s);
  return residuals.unaryExpr(&Soften);
}

// Levenberg's and Marquardt's method with central differences; returns the sum of squares.
double PrismFitter::Refine(PrismParameters& x, double expected_offset_s,
                           std::span<const int> free) const {
  constexpr double kStep = 1e-6, kEnough = 1e-9, kMaxDamping = 1e9;
  const auto size = static_cast<Eigen::Index>(free.size());
  Eigen::VectorXd residuals = Residuals(x, expected_offset_s);
  double damping = 1e-4;
  for (int step = 0; step < kMaxSteps && damping < kMaxDamping; ++step) {
    Eigen::MatrixXd jacobian(residuals.size(), size);
    for (Eigen::Index i = 0; i < size; ++i) {
      const PrismParameters dx = kStep * PrismParameters::Unit(free[static_cast<std::size_t>(i)]);
      jacobian.col(i) =
          (Residuals(x + dx, expected_offset_s) - Residuals(x - dx, expected_offset_s)) /
          (2.0 * kStep);
    }
    const Eigen::MatrixXd normal = jacobian.transpose() * jacobian;
    const Eigen::VectorXd gradient = jacobian.transpose() * residuals;
    for (bool better = false; !better && damping < kMaxDamping; damping *= better ? 0.1 : 10.0) {
      Eigen::MatrixXd damped = normal;
      damped.diagonal() *= 1.0 + damping;
      const Eigen::VectorXd dx = damped.ldlt().solve(gradient);
      PrismParameters moved = x;
      for (Eigen::Index i = 0; i < size; ++i) moved(free[static_cast<std::size_t>(i)]) -= dx(i);
      const Eigen::VectorXd after = Residuals(moved, expected_offset_s);
      better =
          after.squaredNorm() < residuals.squaredNorm() && CountInside(moved) >= enough_inside_;
      if (!better) continue;
      x = moved;
      residuals = after;
      if (dx.norm() < kEnough) return residuals.squaredNorm();
    }
  }
  return residuals.squaredNorm();
}

// The track is a row of straight lines, and where its corners fall on poses no derivative by the
// clock tells the way down: by a golden section of the clock's offset, all else fitted to each.
void PrismFitter::RefineClock(PrismParameters& x, double expected_offset_s,
                              std::span<const int> free) const {
  constexpr double kReach_s = 0.25, kEnough_s = 1e-4;
  const double share = 1.0 / std::numbers::phi;
  double from_s = x(6) - kReach_s, to_s = x(6) + kReach_s;
  double least = Residuals(x, expected_offset_s).squaredNorm();
  PrismParameters best = x;
  const auto cost_at = [&](double clock_offset_s) {
    PrismParameters moved = best;
    moved(6) = clock_offset_s;
    if (CountInside(moved) < enough_inside_) return std::numeric_limits<double>::infinity();
    const double cost = Refine(moved, expected_offset_s, free);
    if (cost < least) least = cost, best = moved;
    return cost;
  };
  double low_s = to_s - share * (to_s - from_s), high_s = from_s + share * (to_s - from_s);
  double low = cost_at(low_s), high = cost_at(high_s);
  while (to_s - from_s > kEnough_s) {
    if (low < high) {
      to_s = high_s, high_s = low_s, high = low;
      low = cost_at(low_s = to_s - share * (to_s - from_s));
    } else {
      from_s = low_s, low_s = high_s, low = high;
      high = cost_at(high_s = from_s + share * (to_s - from_s));
    }
  }
  x = best;
}

PrismParameters PrismFitter::Fit(bool with_scale) const {
  constexpr std::array kAll{0, 1, 2, 3, 4, 5, 6, 7};
  constexpr std::array kWithoutClock{0, 1, 2, 3, 4, 5, 7};
  const std::size_t scales = with_scale ? 1 : 0;
  PrismParameters best = PrismParameters::Zero();
  double least = std::numeric_limits<double>::infinity(), expected_offset_s = 0.0;
  for (int i = 0; i < kHeadings; ++i) {
    for (const double clock_offset_s : {0.0, -1.0, 1.0}) {
      PrismParameters x = PrismParameters::Zero();
      x(0) = -std::numbers::pi + 2.0 * std::numbers::pi * i / kHeadings;
      x(6) = clock_offset_s;
      Eigen::Vector2d shift = Eigen::Vector2d::Zero();
      for (std::size_t k = 0; k < poses_.size(); ++k) {
        shift += (TrackAt(times_s_[k], 0.0) - PrismOf(k, x)) / static_cast<double>(poses_.size());
      }
      x.segment<2>(1) = shift;
      if (CountInside(x) < enough_inside_) continue;
      const double cost = Refine(x, clock_offset_s, std::span(kAll).first(7 + scales));
      if (cost < least) least = cost, best = x, expected_offset_s = clock_offset_s;
    }
  }
  RefineClock(best, expected_offset_s, std::span(kWithoutClock).first(6 + scales));
  return best;
}

}  // namespace rigmap
