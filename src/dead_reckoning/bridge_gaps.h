// Motion that no image shows, by the rover's wheels and gyro.
#pragma once

#include <vector>

#include "dead_reckoning/dead_reckoning_options.h"
#include "scene/dataset.h"
#include "scene/odometry.h"

namespace rigmap {

struct BridgedOdometry {
  Odometry odometry;
  std::vector<int> bridged;  // frames whose step from the frame before is the rover's sensors'
};

// Where the odometry lost its way and began anew, all later frames hang on predicted ones: the
// steps of these become those of the Kalman filter that fuses wheels, gyro and inclinometer with
// the visual motion before and after, each with the covariance by which it grew in between, and
// later frames follow. Everything else stays. The odometry as it is where nothing was lost, the
// rover has no wheels or gyro that can be used, these have a gap there, or the wheels say another
// way than the images in more than half of the steps that both know: then their radius or the IMU's
// axes are not those of this rover.
BridgedOdometry BridgeGaps(const Dataset& dataset, Odometry odometry,
                           const DeadReckoningOptions& options, const FilterOptions& filter);

}  // namespace rigmap
