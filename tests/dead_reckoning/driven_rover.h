// A rover on level ground: where its cameras are, what its sensors measure without any error.
#pragma once

#include <functional>
#include <vector>

#include "dead_reckoning/estimate_motion.h"

namespace rigmap {

struct Drive {
  double speed_mps = 0.2, turn_radps = 0.0;
};

// At rest for four seconds, then as `drive` says at each time (s) after the first frame, which is
// taken when the rest is over; a frame a second. Wheels and gyro at 12.5 and 125 Hz. The rover has
// Katwijk's rig: the IMU 0.54 m above the contact point, the camera 0.38 m before it.
struct DrivenRover {
  Dataset dataset;
  std::vector<Rigid3> gauge_from_left;  // true, gauge: the left camera of the first frame
};
DrivenRover DriveRover(int frames, const std::function<Drive(double)>& drive);

// What the images of these frames show, with a sigma on each axis and no error.
VisualStep TrueStep(const DrivenRover& rover, int from, int to, double sigma_m = 0.003,
                    double sigma_rad = 0.001);

// Each frame measured against the one before, by the motion that `step` gives: frame to the one
// before.
Odometry ChainedOdometry(const DrivenRover& rover, const std::function<Rigid3(int)>& step);
// As the frame truly moved.
Rigid3 TrueMotion(const DrivenRover& rover, int frame);

// Contacts of six wheels, the corner ones steered.
RoverWheels SixWheels();

// Options under which DriveRover's wheels are right.
DeadReckoningOptions WithoutSlip();

}  // namespace rigmap
