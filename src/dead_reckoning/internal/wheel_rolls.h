// How the six wheels of a rover rolled on the way to a frame. Of this room only.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "dead_reckoning/estimate_motion.h"

namespace rigmap {

inline constexpr std::size_t kWheels = 6;
using WheelVector = Eigen::Matrix<double, kWheels, 1>;

// What a wheel's share of the middle axle's way is linear in: the way and the turn, along the
// wheel's heading, and the turn across it. Its factors are its own radius and slip, and how far
// right and ahead of the middle axle's centre it is, m.
using WheelKinematics = Eigen::Matrix<double, 3, kWheels>;

// Of the way to a frame: how far each wheel turned, over the mean of the middle axle.
struct WheelRoll {
  WheelVector shares = WheelVector::Zero();
  WheelKinematics kinematics = WheelKinematics::Zero();
};

// What wheels, their steering and the gyro (less the bias that `motion` has found) say. Keeps a
// reference to the data set.
class WheelRolls {
 public:
  WheelRolls(const Dataset& dataset, const EstimatedMotion& motion, double wheel_radius_m);

  // From the frame before. Nothing where sensors are silent, the rover hardly drove, or a wheel
  // turned backwards.
  std::optional<WheelRoll> To(std::size_t frame) const;

 private:
  struct Moment;
  std::optional<Moment> At(StampNs stamp_ns) const;

  const Dataset& dataset_;
  std::array<std::optional<int>, kWheels> steering_;  // joint of each wheel
  double wheel_radius_m_;
  std::vector<StampNs> stamps_ns_;  // of the gyro
  std::vector<double> yaw_rad_;     // that it turned until then, about the vertical
};

}  // namespace rigmap
