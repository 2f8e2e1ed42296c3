// What the rover's inertial unit writes.
#pragma once

#include <Eigen/Core>
#include <iosfwd>
#include <span>
#include <vector>

#include "simulation/rover_motion.h"
#include "simulation/sensor_clock.h"

namespace rigmap {

// In IMU axes: x backward, y right, z up.
struct ImuSample {
  StampNs stamp_ns = 0;
  Eigen::Vector3d specific_force_mps2;  // acceleration less gravity: +z at rest
  Eigen::Vector3d angular_rate_radps;
  Eigen::Vector3d inclinometer_mps2;  // the same force, slower and steadier
};

// Standard deviations per sample, as in the real files at rest. Vibration makes the accelerometer
// noisy; biases are drawn once for a drive.
struct ImuNoise {
  Eigen::Vector3d specific_force_mps2{0.28, 0.05, 0.16};
  Eigen::Vector3d angular_rate_radps{0.005, 0.003, 0.001};
  Eigen::Vector3d inclinometer_mps2{0.03, 0.013, 0.023};
  double specific_force_bias_mps2 = 0.02;  // sigma, each axis
  double angular_rate_bias_radps = 1e-4;   // sigma, each axis
  double inclinometer_memory = 0.7;        // correlation of its noise from sample to sample

  // No noise at all.
  static ImuNoise None();
};

inline constexpr double kGravity_mps2 = 9.8129;  // at the latitude of Katwijk

// 125 samples per second while the sensors run. One stamp in fourteen is a millisecond late; of
// one sample each second it is due in the last millisecond.
std::vector<ImuSample> SimulateImu(const RoverMotion& motion, const RoverMount& mount,
                                   const SensorClock& clock, const ImuNoise& noise = {});

// imu.txt: stamp, specific force xyz (m/s^2), angular rate xyz (rad/s), inclinometer xyz (m/s^2).
void WriteImuRows(std::ostream& stream, std::span<const ImuSample> samples);

}  // namespace rigmap
