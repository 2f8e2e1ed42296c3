// What inclinometer, gyro and images measure of the state.
#pragma once

#include "dead_reckoning/estimate_motion.h"
#include "dead_reckoning/internal/fixed_interval.h"

namespace rigmap {

Measurement InclinationOf(const Belief& belief, const Eigen::Vector3d& acceleration_in_imu,
                          const RoverModel& model);

// The gyro of a rover that stands still measures its own bias.
Measurement BiasAtRest(const Belief& belief, const MeanRate& rate, const RoverModel& model);

// The motion since the step's first frame, which must be among the clones. `noise_factor`
// multiplies its covariance.
Measurement VisualMotionOf(const Belief& belief, const VisualStep& step, double noise_factor);

// Of the motion since a frame that is among the clones, as a VisualStep's.
Matrix6d CovarianceSince(int frame, const Belief& belief);

}  // namespace rigmap
