// Dead reckoning: how a rover moved, by its wheels, its gyro, its inclinometer and, if there is
// any, visual motion.
//
// The point on the ground amid the wheels moves straight ahead as far as unsteered wheels roll; the
// gyro turns the rover about it; the inclinometer holds it level in the mean. Estimated along with
// the poses: the gyro's bias and scale, the scale of the wheels (radius and lasting slip), the
// direction of travel and the contact point against the IMU, which way is up, the level of the
// inclinometer, the scale of visual motion. Assumed: all stamps are of one clock, the IMU sits
// fixed to the cameras, as the rig states.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "dead_reckoning/dead_reckoning_options.h"
#include "scene/dataset.h"
#include "scene/odometry.h"

namespace rigmap {

// A motion that the images of two frames show; from < to.
struct VisualStep {
  int from = 0, to = 0;
  Rigid3 to_from_from;
  Matrix6d covariance = Matrix6d::Identity();  // left perturbation: translation (m), rotation (rad)
};

// What odometry measured, one step at most for each frame.
std::vector<VisualStep> VisualSteps(const Odometry& odometry);

struct EstimatedPose {
  Rigid3 gauge_from_left;  // gauge: the left camera of the first frame
  // Of its position (m) and rotation (rad, exp(error) * estimated), gauge axes.
  Matrix6d covariance = Matrix6d::Zero();
  // Of left_from_reference's motion, as a left perturbation like a VisualStep's, without what the
  // scale of visual motion adds. Zero where no reference is given.
  Matrix6d since_reference = Matrix6d::Zero();
  bool is_measured = true;  // by images, or by wheels and gyro all the way from the frame before
};

// How much closer the images bear out the motion that the sensors tell than their noise would have
// it: mean squares of normalised innovations, over all visual steps that no slip spoils. As if two
// more steps had been as expected, so that a few do not make much of it. 1 without images.
struct SensorAgreement {
  double along = 1.0, aside = 1.0, turn = 1.0;  // the direction of travel; turns about all axes
};

struct EstimatedMotion {
  std::vector<EstimatedPose> poses;  // of each frame
  // True over stated metres of a wheel's turn, as the whole part tells it, and its sigma.
  double wheel_scale = 1.0, wheel_scale_sigma = 0.0;
  Eigen::Vector3d gyro_bias_radps = Eigen::Vector3d::Zero();
  SensorAgreement agreement;
  std::vector<int> slips;   // frames before which the wheels went another way than the images
  std::vector<int> misled;  // frames whose visual motion nothing else bears out: not used
};

// Share of the visual steps that may be misled; more, and it is the sensors that err.
inline constexpr double kMostMisled = 0.2;

// Of all frames. `visual` may be empty, in any order. `references` name for each frame an earlier
// one, or itself for none, since when its motion is asked for; empty for none at all: the poses of
// both are off together, so that their own covariances do not tell it. A DataError says in one
// sentence why it cannot be done: the rig does not state its IMU, or a sensor that is to be used
// has no samples, a gap (without `visual` only) or a problem.
EstimatedMotion EstimateMotion(const Dataset& dataset, std::span<const VisualStep> visual,
                               const DeadReckoningOptions& options, const FilterOptions& filter,
                               std::span<const int> references = {});

}  // namespace rigmap
