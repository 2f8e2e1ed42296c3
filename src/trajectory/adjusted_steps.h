// How well an adjustment knows the motions from frame to frame.
#pragma once

#include <optional>
#include <vector>

#include "scene/adjustment.h"
#include "scene/odometry.h"

namespace rigmap {

// Per frame, the covariance of its motion against its reference, as OdometryFrame::step_covariance
// is, of noise and calibration together. What the calibration leaves unknown is common to all
// steps: summed up as if they were independent it is too little. Nothing for what the adjustment
// does not tell: frames that it did not pose, or that hang on another datum than their reference.
std::vector<std::optional<Matrix6d>> AdjustedSteps(const Odometry& odometry,
                                                   const Adjustment& adjustment);

}  // namespace rigmap
