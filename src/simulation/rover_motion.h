// How the rover's body lies on the ground that it drives over, and what is mounted on it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <vector>

#include "geometry/rigid3.h"
#include "scene/rig.h"
#include "simulation/rover_path.h"

namespace rigmap {

// Metres up, at a place in metres east and north.
using GroundHeight = std::function<double(double east_m, double north_m)>;

// Wheels in the order of Katwijk's drive joints: front left, front right, middle left, middle
// right, rear left, rear right. Where they touch the ground, in body axes. Not published: from the
// steering angles, wheel ways and bogie angles of the rendered stand-in for the data set, to about
// 5 cm.
inline constexpr double kWheelBase_m = 0.60;  // from middle to front and to rear
inline constexpr double kHalfTrack_m = 0.37;
inline constexpr double kWheelRadius_m = 0.123;
inline constexpr double kWheelWidth_m = 0.25;

inline const std::array<Eigen::Vector2d, 6> kWheelInBody{
    Eigen::Vector2d{kWheelBase_m, kHalfTrack_m},  Eigen::Vector2d{kWheelBase_m, -kHalfTrack_m},
    Eigen::Vector2d{0.0, kHalfTrack_m},           Eigen::Vector2d{0.0, -kHalfTrack_m},
    Eigen::Vector2d{-kWheelBase_m, kHalfTrack_m}, Eigen::Vector2d{-kWheelBase_m, -kHalfTrack_m}};

// Body axes: x forward, y left, z up, origin on the ground under the IMU. The horizontal heading
// of x is the path's; height and tilt are those of the plane through the ground under the six
// wheels (least squares, each wheel feeling the mean of what it covers), smoothed over 0.1 s.
class RoverMotion {
 public:
  // Feels the ground all along the way: 25 times per second of it, 90 heights each. `ground` is
  // not kept.
  RoverMotion(RoverPath path, const GroundHeight& ground);

  const RoverPath& path() const { return path_; }

  // World: metres east, north, up. At any time (see RoverPath::At); twice continuously
  // differentiable but where the path's speeds are not. Thread-safe, about a microsecond.
  Rigid3 WorldFromBody(double time_s) const;

  // Heights of the ground under the wheels, metres up.
  std::array<double, 6> WheelHeights(double time_s) const;

 private:
  // Height of the plane at the origin, its slopes to east and north, heights under the wheels.
  using Footing = Eigen::Matrix<double, 9, 1>;
  Footing FootingAt(double time_s) const;

  RoverPath path_;
  std::vector<Footing> footings_;  // control points of a cubic B-spline over time
};

// What is fixed to the body.
struct RoverMount {
  Rigid3 body_from_left;
  Rigid3 imu_from_left;
  Rigid3 body_from_imu;  // IMU axes: x backward, y right, z up; 0.545 m above the ground
  Eigen::Vector3d antenna_in_left = Eigen::Vector3d::Zero();

  Eigen::Vector3d AntennaInBody() const { return body_from_left * antenna_in_left; }
};

// A rig that does not say where its IMU or its antenna is has LocCam's there: the left camera
// 1.10 m above the ground, looking forward and 17.95 degrees down.
RoverMount MountOf(const StereoRig& rig);

}  // namespace rigmap
