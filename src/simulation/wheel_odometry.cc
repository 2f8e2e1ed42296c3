#include "simulation/internal/wheel_odometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <ostream>

#include "simulation/internal/seeded_noise.h"

namespace rigmap {
namespace {

constexpr double kPeriod_s = 0.08;
constexpr double kJitter_s = 0.006;  // of some rows' times
constexpr double kShareJittered = 0.15;
constexpr double kSteeringRate_radps = 0.35;
constexpr double kStill = 1e-6;             // m/s, rad/s: less is no motion
constexpr double kTiltStep_rad = 0.000498;  // of rocker and bogies, as in the real files
constexpr double kTiltNoise_rad = 0.001;
constexpr double kFullCurrent = 0.9;  // analogue value of a drive at full speed, beside idling
constexpr double kFullRate_radps = 1.5;
constexpr std::array<std::size_t, 4> kSteeredWheels{0, 1, 4, 5};

// What differs from wheel to wheel and stays for a drive.
struct WheelTraits {
  std::array<double, 6> slip{}, burst{}, idle_current{};
  std::array<double, 4> steering_offset_rad{};
};

WheelTraits DrawTraits(SeededNoise& noise) {
  WheelTraits traits;
  for (double& slip : traits.slip) slip = std::max(0.0, 0.03 + noise.Normal(0.01));
  for (double& burst : traits.burst) burst = noise.Between(0.4, 0.6);
  for (double& current : traits.idle_current) current = noise.Between(0.1, 0.8);
  for (double& offset : traits.steering_offset_rad) offset = noise.Normal(0.01);
  return traits;
}

// Rises and falls within each burst; 0 outside, 1 in its middle.
double BurstAt(const std::vector<TimeSpan>& bursts, double time_s) {
  double strongest = 0.0;
  for (const TimeSpan& burst : bursts) {
    if (!burst.Contains(time_s)) continue;
    const double share = (time_s - burst.begin_s) / (burst.end_s - burst.begin_s);
    strongest = std::max(strongest, std::sin(std::numbers::pi * share));
  }
  return strongest;
}

// Velocity of the ground's place under a wheel, in body axes, m/s.
Eigen::Vector2d VelocityOf(std::size_t wheel, const PlanarState& state) {
  const Eigen::Vector2d& position = kWheelInBody[wheel];
  return {state.speed_mps - state.yaw_rate_radps * position.y(),
          state.yaw_rate_radps * position.x()};
}

// Where a corner wheel should point; as it did, at rest.
double WantedSteering(const Eigen::Vector2d& velocity, double steering_rad) {
  if (velocity.norm() < kStill) return steering_rad;
  double wanted_rad = std::atan2(velocity.y(), velocity.x());
  if (velocity.x() < 0.0) wanted_rad -= std::copysign(std::numbers::pi, wanted_rad);
  return std::clamp(wanted_rad, -kLargestSteering_rad, kLargestSteering_rad);
}

void Steer(OdometrySample& sample, const OdometrySample& last, const PlanarState& state,
           double step_s) {
  const double reach_rad = kSteeringRate_radps * step_s;
  for (std::size_t i = 0; i < kSteeredWheels.size(); ++i) {
    const double from_rad = last.steering[i].angle_rad;
    const double wanted_rad = WantedSteering(VelocityOf(kSteeredWheels[i], state), from_rad);
    const double change_rad = std::clamp(wanted_rad - from_rad, -reach_rad, reach_rad);
    sample.steering[i].angle_rad = from_rad + change_rad;
    sample.steering[i].rate_radps = step_s > 0.0 ? change_rad / step_s : 0.0;
  }
}

// Angles of all wheels in the order of the drives; the middle ones point ahead.
std::array<double, 6> WheelDirections(const OdometrySample& sample) {
  std::array<double, 6> directions_rad{};
  for (std::size_t i = 0; i < kSteeredWheels.size(); ++i) {
    directions_rad[kSteeredWheels[i]] = sample.steering[i].angle_rad;
  }
  return directions_rad;
}

void DriveWheels(OdometrySample& sample, const OdometrySample& last, const PlanarState& state,
                 const std::array<double, 6>& slips, double step_s) {
  const auto directions_rad = WheelDirections(sample);
  for (std::size_t i = 0; i < sample.drives.size(); ++i) {
    const Eigen::Vector2d direction(std::cos(directions_rad[i]), std::sin(directions_rad[i]));
    const double ground_mps = direction.dot(VelocityOf(i, state));
    JointReading& drive = sample.drives[i];
    drive.rate_radps = (1.0 + slips[i]) * ground_mps / kWheelRadius_m;
    drive.angle_rad =
        last.drives[i].angle_rad + 0.5 * step_s * (last.drives[i].rate_radps + drive.rate_radps);
  }
}

void Tilt(OdometrySample& sample, const std::array<double, 6>& heights) {
  const auto rise = [&](std::size_t from, std::size_t to) { return heights[to] - heights[from]; };
  sample.rocker_rad = 0.5 * (rise(4, 0) - rise(5, 1)) / (2.0 * kWheelBase_m);
  sample.left_bogie_rad = (rise(0, 2) + rise(4, 2)) / (2.0 * kWheelBase_m);
  sample.right_bogie_rad = (rise(1, 3) + rise(5, 3)) / (2.0 * kWheelBase_m);
}

double InSteps(double value, double step) { return step * std::round(value / step); }

// A sample as its sensors read it: `exact` is kept for the next step.
OdometrySample Read(const OdometrySample& exact, const WheelTraits& traits, SeededNoise& noise) {
  OdometrySample read = exact;
  for (std::size_t i = 0; i < read.drives.size(); ++i) {
    const double share = std::min(1.0, std::abs(exact.drives[i].rate_radps) / kFullRate_radps);
    const double load = kFullCurrent * share * std::max(0.0, 1.0 + noise.Normal(0.8));
    read.drives[i].rate_radps += noise.Normal(0.02 * share);
    read.drives[i].analogue = InSteps(traits.idle_current[i] + load + noise.Normal(0.013), 0.00317);
  }
  for (std::size_t i = 0; i < read.steering.size(); ++i) {
    read.steering[i].rate_radps = InSteps(exact.steering[i].rate_radps, 1e-6);
    read.steering[i].analogue =
        InSteps(exact.steering[i].angle_rad + traits.steering_offset_rad[i] + noise.Normal(0.002),
                0.001032);
  }
  for (double* tilt : {&read.rocker_rad, &read.left_bogie_rad, &read.right_bogie_rad}) {
    *tilt = InSteps(*tilt + noise.Normal(kTiltNoise_rad), kTiltStep_rad);
  }
  return read;
}

}  // namespace

std::vector<OdometrySample> SimulateWheelOdometry(const RoverMotion& motion,
                                                  const SensorClock& clock,
                                                  const std::vector<TimeSpan>& slip_bursts) {
  SeededNoise noise(clock.seed, "odometry");
  const WheelTraits traits = DrawTraits(noise);
  const double first_s = -kSensorsBefore_s + noise.Between(0.0, kPeriod_s);
  const double end_s = motion.path().duration_s() + kSensorsAfter_s;
  std::vector<OdometrySample> samples;
  OdometrySample last;
  last.stamp_ns = clock.StampAt(first_s);
  for (int i = 0; first_s + i * kPeriod_s < end_s; ++i) {
    const bool jittered = i > 0 && noise.Between(0.0, 1.0) < kShareJittered;
    const double jitter_s = jittered ? noise.Between(-kJitter_s, kJitter_s) : 0.0;
    OdometrySample sample;
    sample.stamp_ns = clock.StampAt(first_s + i * kPeriod_s + jitter_s);
    const double time_s = clock.TimeAt(sample.stamp_ns);
    const double step_s = time_s - clock.TimeAt(last.stamp_ns);
    const PlanarState state = motion.path().At(time_s);
    std::array<double, 6> slips = traits.slip;
    const double burst = BurstAt(slip_bursts, time_s);
    for (std::size_t k = 0; k < slips.size(); ++k) slips[k] += burst * traits.burst[k];
    Steer(sample, last, state, step_s);
    DriveWheels(sample, last, state, slips, step_s);
    Tilt(sample, motion.WheelHeights(time_s));
    samples.push_back(Read(sample, traits, noise));
    last = sample;
  }
  return samples;
}

void WriteOdometryRows(std::ostream& stream, std::span<const OdometrySample> samples) {
  std::string row;
  const auto add = [&row](const JointReading& joint) {
    fmt::format_to(std::back_inserter(row), " {:.9g} {:.9g} {:.9g}", joint.angle_rad,
                   joint.rate_radps, joint.analogue);
  };
  for (const OdometrySample& sample : samples) {
    row = FormatKatwijkStampAsRecorded(sample.stamp_ns);
    std::ranges::for_each(sample.drives, add);
    std::ranges::for_each(sample.steering, add);
    stream << fmt::format("{} {:.15g} {:.15g} {:.15g}\n", row, sample.rocker_rad,
                          sample.left_bogie_rad, sample.right_bogie_rad);
  }
}

}  // namespace rigmap
