// Verified matches of one pair of frames.
#pragma once

#include <vector>

#include "correspondence/feature_matching.h"
#include "correspondence/stereo_pose.h"
#include "matching/frame_window.h"
#include "matching/internal/pair_selection.h"

namespace rigmap {

struct VerifiedPair {
  std::vector<FeatureMatch> matches;
  // The motion that they agree with; nothing without matches.
  std::optional<StereoPose> b_from_a;
};

// What a motion is to fulfil that two matched frames agree with.
StereoPoseOptions PairPoseOptions(const MatchingOptions& options);

// Matches whose stereo point in a agrees with both eyes of b under one motion, searched for near
// where `predicted_b_from_a` shows it: within search_radius_px if that motion was measured, else
// within as much more as the odometry may be off after so many frames.
VerifiedPair VerifyPair(const CandidatePair& pair, const Rigid3& predicted_b_from_a,
                        const MatchedFrame& a, const MatchedFrame& b, const StereoRig& rig,
                        const MatchingOptions& options);

}  // namespace rigmap
