// What the rover's joints write.
#pragma once

#include <array>
#include <iosfwd>
#include <span>
#include <vector>

#include "simulation/rover_motion.h"
#include "simulation/sensor_clock.h"

namespace rigmap {

struct JointReading {
  double angle_rad = 0.0, rate_radps = 0.0;
  double analogue = 0.0;  // the motor's current (drives), the angle's other sensor (steering)
};

struct OdometrySample {
  StampNs stamp_ns = 0;
  // In the order of kWheelInBody. Positive: forwards.
  std::array<JointReading, 6> drives;
  // Front left, front right, rear left, rear right. Positive: the wheel points to the left.
  std::array<JointReading, 4> steering;
  // Half of what the left side's line from rear to front wheel points up more than the right's.
  double rocker_rad = 0.0;
  // How much the line from middle to front wheel points down more than the one from rear to front.
  double left_bogie_rad = 0.0, right_bogie_rad = 0.0;
};

inline constexpr double kLargestSteering_rad = 0.8726646;  // 50 degrees

// 12.5 samples per second while the sensors run. A wheel rolls with its contact's horizontal speed
// along its direction, times 1 + slip: some percent, different from wheel to wheel, and up to 60 %
// more within `slip_bursts`. Corner wheels are steered across the line to the centre of the turn,
// as far as they go and no faster than they can; drives count from the first sample on. Signs are
// those of the rendered stand-in for Katwijk; the real excerpt stands still, so that it cannot
// tell.
std::vector<OdometrySample> SimulateWheelOdometry(const RoverMotion& motion,
                                                  const SensorClock& clock,
                                                  const std::vector<TimeSpan>& slip_bursts);

// odometry.txt: stamp, then angle, rate and analogue value of six drives and four steering joints,
// then rocker, left bogie, right bogie: 34 fields.
void WriteOdometryRows(std::ostream& stream, std::span<const OdometrySample> samples);

}  // namespace rigmap
