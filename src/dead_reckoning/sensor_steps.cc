#include "dead_reckoning/internal/sensor_steps.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rigmap {
namespace {

constexpr double kSecondsPerNs = 1e-9;
// Slower than this no wheel turns: a degree in eight minutes.
constexpr double kStill_radps = 1e-4;
constexpr std::array<std::size_t, 2> kMiddleAxle{2, 3};  // of the drives

StampNs Nanoseconds(double seconds) { return static_cast<StampNs>(std::llround(1e9 * seconds)); }

// Radians that the rover's wheels turned over the ground, straight ahead, between two samples.
double TurnedAhead(const WheelSample& from, const WheelSample& to, const StereoRig& rig) {
  const auto turned = [&](std::size_t drive) {
    return to.drive_angle_rad[drive] - from.drive_angle_rad[drive];
  };
  if (!rig.wheels) return 0.5 * (turned(kMiddleAxle[0]) + turned(kMiddleAxle[1]));
  double sum_rad = 0.0;
  for (std::size_t i = 0; i < rig.wheels->wheels.size(); ++i) {
    const auto& joint = rig.wheels->wheels[i].steering;
    const double steering_rad =
        joint ? 0.5 * (from.steering_rad[*joint] + to.steering_rad[*joint]) : 0.0;
    sum_rad += std::cos(steering_rad) * turned(i);
  }
  return sum_rad / static_cast<double>(rig.wheels->wheels.size());
}

bool Moves(const WheelSample& sample) {
  return std::ranges::any_of(sample.drive_rate_radps,
                             [](double rate) { return std::abs(rate) > kStill_radps; });
}

Eigen::Vector3d RateAt(StampNs stamp_ns, const InertialSample& before,
                       const InertialSample& after) {
  const double share = static_cast<double>(stamp_ns - before.stamp_ns) /
                       static_cast<double>(after.stamp_ns - before.stamp_ns);
  return before.angular_rate_radps + share * (after.angular_rate_radps - before.angular_rate_radps);
}

}  // namespace

double WheelRadius(const StereoRig& rig, const DeadReckoningOptions& options) {
  return rig.wheels ? rig.wheels->radius_m.value_or(options.wheel_radius_m)
                    : options.wheel_radius_m;
}

WheelWay::WheelWay(const WheelRecord& wheels, const StereoRig& rig,
                   const DeadReckoningOptions& options)
    : max_gap_ns_(Nanoseconds(options.max_gap_s)) {
  const double metres_per_rad = WheelRadius(rig, options) / (1.0 + options.wheel_slip);
  double way_m = 0.0;
  for (std::size_t i = 0; i < wheels.samples.size(); ++i) {
    const WheelSample& sample = wheels.samples[i];
    if (i > 0) way_m += metres_per_rad * TurnedAhead(wheels.samples[i - 1], sample, rig);
    stamps_ns_.push_back(sample.stamp_ns);
    way_m_.push_back(way_m);
    moves_.push_back(Moves(sample));
  }
}

std::optional<double> WheelWay::At(StampNs stamp_ns) const {
  const auto after = std::ranges::lower_bound(stamps_ns_, stamp_ns);
  if (after == stamps_ns_.end()) return std::nullopt;
  const auto i = static_cast<std::size_t>(after - stamps_ns_.begin());
  if (*after == stamp_ns) return way_m_[i];
  if (i == 0 || stamps_ns_[i] - stamps_ns_[i - 1] > max_gap_ns_) return std::nullopt;
  const double share = static_cast<double>(stamp_ns - stamps_ns_[i - 1]) /
                       static_cast<double>(stamps_ns_[i] - stamps_ns_[i - 1]);
  return way_m_[i - 1] + share * (way_m_[i] - way_m_[i - 1]);
}

std::optional<double> WheelWay::Between(StampNs begin_ns, StampNs end_ns) const {
  const auto begin_m = At(begin_ns), end_m = At(end_ns);
  if (!begin_m || !end_m) return std::nullopt;
  return *end_m - *begin_m;
}

bool WheelWay::StandsStill(StampNs begin_ns, StampNs end_ns) const {
  if (!At(begin_ns) || !At(end_ns)) return false;
  auto first = std::ranges::lower_bound(stamps_ns_, begin_ns);
  if (first != stamps_ns_.begin() && *first > begin_ns) --first;
  for (auto stamp = first; stamp != stamps_ns_.end(); ++stamp) {
    if (stamp != first && *stamp - *std::prev(stamp) > max_gap_ns_) return false;
    if (moves_[static_cast<std::size_t>(stamp - stamps_ns_.begin())]) return false;
    if (*stamp >= end_ns) break;
  }
  return true;
}

SensorSteps CutSteps(StampNs begin_ns, StampNs end_ns, std::span<const InertialSample> inertial,
                     const WheelWay& way, const DeadReckoningOptions& options) {
  const StampNs max_gap_ns = Nanoseconds(options.max_gap_s);
  SensorSteps steps;
  StampNs from_ns = begin_ns;
  auto after = std::ranges::upper_bound(inertial, begin_ns, {}, &InertialSample::stamp_ns);
  while (from_ns < end_ns) {
    const StampNs to_ns = after == inertial.end() ? end_ns : std::min(end_ns, after->stamp_ns);
    SensorStep step{kSecondsPerNs * static_cast<double>(to_ns - from_ns), std::nullopt,
                    way.Between(from_ns, to_ns)};
    const bool is_between = after != inertial.begin() && after != inertial.end();
    if (is_between && after->stamp_ns - std::prev(after)->stamp_ns <= max_gap_ns) {
      step.turn_rate_radps = 0.5 * (RateAt(from_ns, *std::prev(after), *after) +
                                    RateAt(to_ns, *std::prev(after), *after));
    }
    steps.push_back(step);
    from_ns = to_ns;
    if (after != inertial.end()) ++after;
  }
  return steps;
}

Eigen::Vector3d ContactInImu(const StereoRig& rig, const DeadReckoningOptions& options) {
  if (!rig.wheels) return {0.0, 0.0, -options.imu_height_m};
  Eigen::Vector3d all = Eigen::Vector3d::Zero();
  double unsteered_x = 0.0;
  int unsteered = 0;
  for (const RoverWheel& wheel : rig.wheels->wheels) {
    all += wheel.contact_in_imu / static_cast<double>(rig.wheels->wheels.size());
    if (wheel.steering) continue;
    unsteered_x += wheel.contact_in_imu.x();
    ++unsteered;
  }
  if (unsteered > 0) all.x() = unsteered_x / unsteered;
  return all;
}

MeanRate MeanRateBetween(StampNs begin_ns, StampNs end_ns,
                         std::span<const InertialSample> inertial) {
  const auto first = std::ranges::lower_bound(inertial, begin_ns, {}, &InertialSample::stamp_ns);
  MeanRate mean;
  int count = 0;
  StampNs last_ns = begin_ns;
  for (auto sample = first; sample != inertial.end() && sample->stamp_ns <= end_ns; ++sample) {
    mean.radps += sample->angular_rate_radps;
    last_ns = sample->stamp_ns;
    ++count;
  }
  if (count < 2) return {};
  mean.radps /= count;
  mean.duration_s = kSecondsPerNs * static_cast<double>(last_ns - first->stamp_ns);
  return mean;
}

std::optional<Gap> FindGap(std::span<const StampNs> stamps_ns, StampNs begin_ns, StampNs end_ns,
                           double max_gap_s) {
  const StampNs max_gap_ns = Nanoseconds(max_gap_s);
  StampNs last_ns = begin_ns;
  for (auto next = std::ranges::upper_bound(stamps_ns, begin_ns);; ++next) {
    const bool is_end = next == stamps_ns.end() || *next >= end_ns;
    const StampNs next_ns = is_end ? end_ns : *next;
    if (next_ns - last_ns > max_gap_ns) {
      return Gap{last_ns, kSecondsPerNs * static_cast<double>(next_ns - last_ns)};
    }
    if (is_end) return std::nullopt;
    last_ns = next_ns;
  }
}

}  // namespace rigmap
