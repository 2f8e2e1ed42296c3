// Motion where no image tells it.
#pragma once

#include "scene/odometry.h"

namespace rigmap {

// World pose at stamp_ns if the motion between the last two frames went on; the last pose where
// there is no motion to carry on. Time may run backwards, from frame to frame and to stamp_ns.
Rigid3 PredictPose(const Odometry& so_far, StampNs stamp_ns);

// Gives every predicted frame the covariance of its step from its reference: speed and turn rate
// may be others by so much (one standard deviation), and stay so until something is measured again.
// The sum over a gap grows with its duration, whatever the number of frames in it. What speed it is
// a share of, is judged by the fastest of the whole part, since a rig that stands may start.
struct UnmeasuredMotion {
  double speed_change_share = 0.0;
  double turn_change_rad_per_s = 0.0;  // rad/s
};
void SetPredictionCovariances(Odometry& odometry, const UnmeasuredMotion& unmeasured);

// Moves each run of predicted frames that lies between two frames on one connected chain of
// references onto the path between them, in proportion to time.
void BridgePredicted(Odometry& odometry);

}  // namespace rigmap
