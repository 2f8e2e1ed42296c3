// Motion where keypoints are not found again, by corners that are followed.
#pragma once

#include <functional>

#include "odometry/odometry_options.h"
#include "scene/features.h"
#include "scene/odometry.h"
#include "scene/rig.h"

namespace rigmap {

// Features of two frames; equal tracks show the same point. Without features where an image cannot
// be had.
struct FollowedCorners {
  FrameFeatures from, to;
};
using CornerSource = std::function<FollowedCorners(int from, int to)>;

// Where the odometry lost its way (LostFrames) because images are blurred, or too different in
// sharpness, for descriptors to agree, what is followed from image to image may still lead on: each
// such frame is posed against the frame before, or the last before that shows enough, by corners;
// later frames follow. Most of what was followed must agree. Asks for corners of frames that are
// lost only. Everything else stays.
Odometry BridgeByCorners(Odometry odometry, const CornerSource& follow, const StereoRig& rig,
                         const OdometryOptions& options);

}  // namespace rigmap
