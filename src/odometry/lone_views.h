// Motion across gaps by images of which the other eye's is missing.
#pragma once

#include <functional>
#include <vector>

#include "odometry/odometry_options.h"
#include "scene/features.h"
#include "scene/odometry.h"
#include "scene/rig.h"

namespace rigmap {

// Keypoints of one eye's image; `left` of each feature is a pixel of that eye, without a match.
struct LoneView {
  Eye eye = Eye::kLeft;
  FrameFeatures features;
};

// Those of a stretch, both of its ends excluded, in order of time.
using LoneViewSource = std::function<std::vector<LoneView>(StampNs after, StampNs before)>;

// Where the odometry lost its way (LostFrames) two stereo frames may both show ground that a lone
// image between them shows: each is posed against it by its own stereo points, and so the later one
// against the earlier, with the covariances of both. The lost frame so posed hangs on the earlier
// one, and later frames follow; guesses in between are moved onto the way between both. A frame of
// the odometry of which one image is there is posed by it, as a lost frame at the end of a part is
// that has such. Asks for the views of stretches that are lost only. Everything else stays.
Odometry BridgeByLoneViews(Odometry odometry, const FeatureSource& features,
                           const LoneViewSource& views, const StereoRig& rig,
                           const OdometryOptions& options);

}  // namespace rigmap
