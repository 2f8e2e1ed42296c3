// Motion that no image shows, by the rover's wheels and gyro.
#pragma once

#include "dead_reckoning/dead_reckoning_options.h"
#include "scene/dataset.h"
#include "scene/odometry.h"

namespace rigmap {

// Where the odometry lost its way and began anew, all later frames hang on predicted ones; and a
// motion that repeats itself, as sand does, may be found wrongly. The steps of lost frames, and
// those that wheels and gyro contradict by more than slip explains, become those of the Kalman
// filter that fuses wheels, gyro and inclinometer with the visual motion before and after
// (OdometryFrame::bridged), each with its own covariance, and later frames
// follow. How well images bear the sensors out on the other steps scales that covariance; where
// they show the wheels to slip on a share of these, the wheels may slip as often where no image
// tells; where the six turn unlike each other there, they do. Everything else stays. The odometry
// as it is where the rover has no wheels or gyro that can be used, these have a gap there, or they
// contradict more than half of the steps by slip or a fifth otherwise: then their radius or the
// IMU's axes are not those of this rover.
Odometry BridgeGaps(const Dataset& dataset, Odometry odometry, const DeadReckoningOptions& options,
                    const FilterOptions& filter);

}  // namespace rigmap
