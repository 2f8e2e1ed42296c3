// The stage `matching`: pairs of frames that geometry suggests become verified correspondences.
#pragma once

#include "matching/frame_window.h"
#include "matching/matching_options.h"
#include "scene/correspondences.h"
#include "scene/odometry.h"
#include "scene/rig.h"
#include "scene/sampled_features.h"

namespace rigmap {

// Matches each selected pair near the positions that odometry predicts, keeps what agrees with one
// motion of the rig (stereo points of one frame against both eyes of the other), and refines the
// positions by patch alignment with the first view of each ground point. Where few are found again,
// points become features of the other frame by their patches alone, behind those extracted, if
// `sample` is given. Several threads ask for features at a time, one for features to be sampled.
Correspondences MatchFrames(const Odometry& odometry, const FeatureSource& features,
                            const StereoRig& rig, const MatchingOptions& options,
                            const FeatureSampler& sample = {});

}  // namespace rigmap
