// A rover's drive over the plane and what its receiver makes of it.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "georeference/rigid2.h"
#include "scene/survey.h"
#include "scene/trajectory.h"
#include "tests/support/seeded_random.h"

namespace rigmap {

// Speed (m/s) and turn rate (rad/s) at a time (s).
using Steering = std::function<Eigen::Vector2d(double time_s)>;

Steering SCurve();           // 0.3 m/s, turning left and right
Steering Straight();         // 0.3 m/s
Steering Circle();           // 0.3 m/s on 3 m radius
Steering StraightAndStop();  // 0.3 m/s, standing still every other ten seconds

// Katwijk's antenna, left camera axes, metres.
inline const Eigen::Vector3d kAntennaInLeft{0.027, -0.786, -0.888};

class RoverDrive {
 public:
  // Starts at the world's origin along x. The camera looks 18 degrees down, rolling a little.
  RoverDrive(const Steering& steering, double duration_s);

  Rigid3 WorldFromLeft(double time_s) const;
  double duration_s() const { return duration_s_; }

  // Poses 2.5 times a second with errors of this sigma (m, each axis).
  Trajectory Poses(double sigma_m, SeededRandom& random) const;

  // Fixes every 3 s of the antenna, whose clock is ahead by this; normal noise of 4 mm east and
  // 5 mm north, and stated so. `plane_from_world` gives metres east and north of a place at
  // Katwijk.
  std::vector<GnssFix> Fixes(const Rigid2& plane_from_world, double clock_offset_s,
                             SeededRandom& random) const;

 private:
  double duration_s_;
  std::vector<Eigen::Vector3d> states_;  // x, y, heading every 10 ms
};

}  // namespace rigmap
