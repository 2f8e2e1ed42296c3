// Motion where no image tells it.
#pragma once

#include "odometry/odometry_options.h"
#include "scene/odometry.h"

namespace rigmap {

// World pose at stamp_ns if the motion between the last two frames went on; the last pose where
// there is no motion to carry on. Time may run backwards, from frame to frame and to stamp_ns.
Rigid3 PredictPose(const Odometry& so_far, StampNs stamp_ns);

// Gives every predicted frame the covariance of its step from its reference: speed and turn rate
// may change as the options allow. What speed that is of, is judged by the fastest of the whole
// part, since a rig that stands may start.
void SetPredictionCovariances(Odometry& odometry, const OdometryOptions& options);

// Moves each run of predicted frames that lies between two frames on one connected chain of
// references onto the path between them, in proportion to time.
void BridgePredicted(Odometry& odometry);

}  // namespace rigmap
