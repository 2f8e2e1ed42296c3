#include "dead_reckoning/internal/wheel_rolls.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <utility>

namespace rigmap {
namespace {

constexpr Eigen::Index kMiddleLeft = 2, kMiddleRight = 3;

// The corners' joints, unless the rig states which wheel is steered by which.
std::array<std::optional<int>, kWheels> SteeringOf(const StereoRig& rig) {
  std::array<std::optional<int>, kWheels> joints{0, 1, std::nullopt, std::nullopt, 2, 3};
  if (!rig.wheels || rig.wheels->wheels.size() != kWheels) return joints;
  for (std::size_t k = 0; k < kWheels; ++k) joints[k] = rig.wheels->wheels[k].steering;
  return joints;
}

double YawRate(const InertialSample& sample, const EstimatedMotion& motion) {
  return (sample.angular_rate_radps - motion.gyro_bias_radps)
      .dot(sample.inclination_mps2.stableNormalized());
}

// The later of the two samples about a time and the share of the way there from the one before;
// the first sample of all has none before it.
struct Between {
  std::size_t later = 0;
  double share = 1.0;

  template <class Values>
  double Of(const Values& values) const {
    return std::lerp(values(later == 0 ? 0 : later - 1), values(later), share);
  }
};

template <class Samples, class StampOf>
std::optional<Between> Find(const Samples& samples, StampNs stamp_ns, StampOf stamp_of) {
  const auto later = std::ranges::lower_bound(samples, stamp_ns, {}, stamp_of);
  if (later == samples.end()) return std::nullopt;
  const StampNs later_ns = std::invoke(stamp_of, *later);
  if (later_ns == stamp_ns) return Between{static_cast<std::size_t>(later - samples.begin())};
  if (later == samples.begin()) return std::nullopt;
  const StampNs earlier_ns = std::invoke(stamp_of, *std::prev(later));
  return Between{
      static_cast<std::size_t>(later - samples.begin()),
      static_cast<double>(stamp_ns - earlier_ns) / static_cast<double>(later_ns - earlier_ns)};
}

}  // namespace

// The joints of the wheels, and how far the rover has turned.
struct WheelRolls::Moment {
  WheelVector drives_rad = WheelVector::Zero(), steering_rad = WheelVector::Zero();
  double yaw_rad = 0.0;

  double MiddleAxle() const { return 0.5 * (drives_rad(kMiddleLeft) + drives_rad(kMiddleRight)); }
};

WheelRolls::WheelRolls(const Dataset& dataset, const EstimatedMotion& motion, double wheel_radius_m)
    : dataset_(dataset), steering_(SteeringOf(dataset.rig)), wheel_radius_m_(wheel_radius_m) {
  double yaw_rad = 0.0;
  const InertialSample* before = nullptr;
  for (const InertialSample& sample : dataset.inertial.samples) {
    if (before) {
      const double step_s = 1e-9 * static_cast<double>(sample.stamp_ns - before->stamp_ns);
      yaw_rad += 0.5 * step_s * (YawRate(*before, motion) + YawRate(sample, motion));
    }
    stamps_ns_.push_back(sample.stamp_ns);
    yaw_rad_.push_back(yaw_rad);
    before = &sample;
  }
}

std::optional<WheelRoll> WheelRolls::To(std::size_t frame) const {
  constexpr double kLeastWay_m = 0.05;
  const StampNs begin_ns = dataset_.frames[frame - 1].stamp_ns,
                end_ns = dataset_.frames[frame].stamp_ns;
  std::vector<StampNs> stamps_ns;
  const auto& samples = dataset_.wheels.samples;
  for (auto sample = std::ranges::upper_bound(samples, begin_ns, {}, &WheelSample::stamp_ns);
       sample != samples.end() && sample->stamp_ns < end_ns; ++sample) {
    stamps_ns.push_back(sample->stamp_ns);
  }
  stamps_ns.push_back(end_ns);
  const auto first = At(begin_ns);
  if (!first) return std::nullopt;
  WheelRoll roll;
  Moment from = *first;
  for (const StampNs stamp_ns : stamps_ns) {
    const auto to = At(stamp_ns);
    if (!to) return std::nullopt;
    const Eigen::Array<double, 1, kWheels> heading =
        0.5 * (from.steering_rad + to->steering_rad).transpose().array();
    const double way_m = wheel_radius_m_ * (to->MiddleAxle() - from.MiddleAxle()),
                 turn_rad = to->yaw_rad - from.yaw_rad;
    roll.kinematics.row(0) += (way_m * heading.cos()).matrix();
    roll.kinematics.row(1) += (turn_rad * heading.cos()).matrix();
    roll.kinematics.row(2) += (turn_rad * heading.sin()).matrix();
    from = *to;
  }
  const WheelVector turned_m = wheel_radius_m_ * (from.drives_rad - first->drives_rad);
  const double way_m = wheel_radius_m_ * (from.MiddleAxle() - first->MiddleAxle());
  if (std::abs(way_m) < kLeastWay_m || (turned_m.array() * way_m <= 0.0).any()) {
    return std::nullopt;
  }
  roll.shares = turned_m / way_m;
  roll.kinematics /= way_m;
  return roll;
}

std::optional<WheelRolls::Moment> WheelRolls::At(StampNs stamp_ns) const {
  const auto& samples = dataset_.wheels.samples;
  const auto of_wheels = Find(samples, stamp_ns, &WheelSample::stamp_ns);
  const auto of_gyro = Find(stamps_ns_, stamp_ns, std::identity());
  if (!of_wheels || !of_gyro) return std::nullopt;
  Moment moment;
  for (std::size_t k = 0; k < kWheels; ++k) {
    const auto wheel = static_cast<Eigen::Index>(k);
    moment.drives_rad(wheel) =
        of_wheels->Of([&](std::size_t i) { return samples[i].drive_angle_rad[k]; });
    if (!steering_[k]) continue;
    const auto joint = static_cast<std::size_t>(*steering_[k]);
    moment.steering_rad(wheel) =
        of_wheels->Of([&](std::size_t i) { return samples[i].steering_rad[joint]; });
  }
  moment.yaw_rad = of_gyro->Of([&](std::size_t i) { return yaw_rad_[i]; });
  return moment;
}

}  // namespace rigmap
