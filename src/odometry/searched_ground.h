// Motion where keypoints are not found again, by ground that is searched where it has to be.
#pragma once

#include "odometry/odometry_options.h"
#include "scene/features.h"
#include "scene/odometry.h"
#include "scene/rig.h"
#include "scene/sampled_features.h"

namespace rigmap {

// Frames that sensors pose (OdometryFrame::bridged), or that are guessed, are posed by their images
// where these show the ground of the frame before, or of their reference, within some pixels of
// where that pose shows it: over flat sand a keypoint found in one frame is seldom one in the next,
// as its ground is stretched by half, but its patch, stretched likewise, is there. Most of what was
// found must agree on one motion. The step becomes the mean of that and of the sensors', by their
// covariances; where these contradict each other, the one that is known better. Later frames
// follow. Asks for the frames at such steps only; everything else stays.
Odometry BridgeBySearch(Odometry odometry, const FeatureSource& features,
                        const FeatureSampler& sample, const StereoRig& rig,
                        const OdometryOptions& options);

}  // namespace rigmap
