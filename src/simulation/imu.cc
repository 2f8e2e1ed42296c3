#include "simulation/internal/imu.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <ostream>

#include "simulation/internal/seeded_noise.h"

namespace rigmap {
namespace {

constexpr StampNs kMillisecondNs = 1'000'000;
constexpr StampNs kPeriodNs = 8 * kMillisecondNs;
// A second has a whole number of periods, so that this stays: the last sample of each second is
// due at millisecond 999.
constexpr StampNs kPhaseNs = 7 * kMillisecondNs;
constexpr double kShareLate = 0.07;
constexpr double kFastStep_s = 0.02;  // either side, of differences for the accelerometer and gyro
constexpr double kSlowStep_s = 0.10;  // for the inclinometer

// By central differences over `step_s` either side.
Eigen::Vector3d SpecificForce(const RoverMotion& motion, const RoverMount& mount, double time_s,
                              double step_s) {
  const Rigid3 world_from_imu = motion.WorldFromBody(time_s) * mount.body_from_imu;
  const Eigen::Vector3d& imu_in_body = mount.body_from_imu.translation;
  const Eigen::Vector3d before = motion.WorldFromBody(time_s - step_s) * imu_in_body;
  const Eigen::Vector3d after = motion.WorldFromBody(time_s + step_s) * imu_in_body;
  const Eigen::Vector3d acceleration =
      (before - 2.0 * world_from_imu.translation + after) / (step_s * step_s);
  return world_from_imu.rotation.conjugate() *
         (acceleration + kGravity_mps2 * Eigen::Vector3d::UnitZ());
}

Eigen::Vector3d AngularRate(const RoverMotion& motion, const RoverMount& mount, double time_s) {
  const Rigid3 before = motion.WorldFromBody(time_s - kFastStep_s) * mount.body_from_imu;
  const Rigid3 after = motion.WorldFromBody(time_s + kFastStep_s) * mount.body_from_imu;
  return LogRotation(before.rotation.conjugate() * after.rotation) / (2.0 * kFastStep_s);
}

// The first stamp of the IMU's beat that is not before `stamp_ns`.
StampNs OnBeat(StampNs stamp_ns) {
  const StampNs beats = (stamp_ns - kPhaseNs + kPeriodNs - 1) / kPeriodNs;
  return beats * kPeriodNs + kPhaseNs;
}

}  // namespace

ImuNoise ImuNoise::None() {
  const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
  return {zero, zero, zero, 0.0, 0.0, 0.0};
}

std::vector<ImuSample> SimulateImu(const RoverMotion& motion, const RoverMount& mount,
                                   const SensorClock& clock, const ImuNoise& noise) {
  SeededNoise random(clock.seed, "imu");
  const Eigen::Vector3d ones = Eigen::Vector3d::Ones();
  const Eigen::Vector3d force_bias = random.Normal(noise.specific_force_bias_mps2 * ones);
  const Eigen::Vector3d rate_bias = random.Normal(noise.angular_rate_bias_radps * ones);
  const double fresh = std::sqrt(1.0 - noise.inclinometer_memory * noise.inclinometer_memory);
  Eigen::Vector3d drift = random.Normal(noise.inclinometer_mps2);
  const StampNs end_ns = clock.StampAt(motion.path().duration_s() + kSensorsAfter_s);
  std::vector<ImuSample> samples;
  for (StampNs due_ns = OnBeat(clock.StampAt(-kSensorsBefore_s)); due_ns < end_ns;
       due_ns += kPeriodNs) {
    const double time_s = clock.TimeAt(due_ns);
    const bool late = random.Between(0.0, 1.0) < kShareLate;
    drift = noise.inclinometer_memory * drift + fresh * random.Normal(noise.inclinometer_mps2);
    samples.push_back(
        {due_ns + (late ? kMillisecondNs : 0),
         SpecificForce(motion, mount, time_s, kFastStep_s) + force_bias +
             random.Normal(noise.specific_force_mps2),
         AngularRate(motion, mount, time_s) + rate_bias + random.Normal(noise.angular_rate_radps),
         SpecificForce(motion, mount, time_s, kSlowStep_s) + drift});
  }
  return samples;
}

void WriteImuRows(std::ostream& stream, std::span<const ImuSample> samples) {
  std::string row;
  for (const ImuSample& sample : samples) {
    row = FormatKatwijkStampAsRecorded(sample.stamp_ns);
    for (const auto* triple :
         {&sample.specific_force_mps2, &sample.angular_rate_radps, &sample.inclinometer_mps2}) {
      fmt::format_to(std::back_inserter(row), " {:.15g} {:.15g} {:.15g}", triple->x(), triple->y(),
                     triple->z());
    }
    stream << row << '\n';
  }
}

}  // namespace rigmap
