// The state that dead reckoning estimates, how its errors are counted, and how it moves on by what
// wheels and gyro say.
#pragma once

#include "dead_reckoning/dead_reckoning_options.h"
#include "dead_reckoning/internal/sensor_steps.h"
#include "geometry/rigid3.h"
#include "scene/rig.h"
#include "scene/trajectory.h"

namespace rigmap {

// Where each part of the state begins in a vector of errors. The gauge is the left camera of the
// first frame, exactly.
enum StateIndex : int {
  kPosition = 0,     // 3, m: of the left camera, gauge axes, true minus estimated
  kRotation = 3,     // 3, rad: about gauge axes, true = exp(error) * estimated
  kGyroBias = 6,     // 3, rad/s, IMU axes
  kGyroScale = 9,    // 1, share: rate = (1 + scale) (measured - bias)
  kWheelScale = 10,  // 1, log of true over stated metres
  kTravel = 11,      // 2, rad: the direction of travel is the IMU's -x, turned about its y and z
  kContact = 13,     // 3, m: correction of ContactInImu
  kUp = 16,          // 3, rad: rotation of the up direction, gauge axes
  kLevel = 19,       // 2, rad: the inclinometer is turned by this about the IMU's x and y
  kStateSize = 21,
};
using StateVector = Eigen::Matrix<double, kStateSize, 1>;
using StateMatrix = Eigen::Matrix<double, kStateSize, kStateSize>;

struct RoverState {
  Rigid3 gauge_from_left;
  Eigen::Vector3d up_in_gauge = Eigen::Vector3d::UnitZ();
  StateVector values = StateVector::Zero();  // of all but position, rotation and up
};

// The state with an error added; the error that takes b to a.
RoverState Corrected(const RoverState& state, const StateVector& error);
StateVector ErrorBetween(const RoverState& a, const RoverState& b);

Rigid3 Corrected(const Rigid3& pose, const Vector6d& error);
Vector6d ErrorBetween(const Rigid3& a, const Rigid3& b);

// What is known before anything is measured, with up as the first inclination says.
StateVector PriorSigmas(const DeadReckoningOptions& options);

// A state a while later: its error is `transition` times the error before, plus noise.
struct Prediction {
  RoverState state;
  StateMatrix transition = StateMatrix::Identity();
  StateMatrix noise = StateMatrix::Zero();
  Eigen::Vector3d way_in_gauge = Eigen::Vector3d::Zero();  // as the wheels tell it
};

struct RoverModel {
  Rigid3 imu_from_left;
  Eigen::Vector3d contact_in_imu;
  DeadReckoningOptions options;
  FilterOptions filter;
};

// What the rover is taken to do where its sensors are silent.
struct CarriedMotion {
  double speed_mps = 0.0;
  Eigen::Vector3d turn_radps = Eigen::Vector3d::Zero();  // IMU axes
};

// Small rotations one after the other, each with its part of the way straight ahead of the contact
// point; the camera sways about that point. Where no wheel tells the way, or no gyro the turn,
// those that are carried on stand in, with the filter's sigmas.
Prediction Predict(const RoverState& state, const SensorSteps& steps, const CarriedMotion& carried,
                   const RoverModel& model);

}  // namespace rigmap
