// The motion between two frames of which nothing is known but that they may show the same ground.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "correspondence/feature_matching.h"
#include "correspondence/stereo_points.h"
#include "correspondence/stereo_pose.h"
#include "matching/matching_options.h"

namespace rigmap {

// A frame as the search for loop closures holds it.
struct SearchedFrame {
  FrameFeatures features;
  std::vector<std::optional<StereoPoint>> points;  // of each feature
  std::vector<int> groups;                         // of each feature: only equal ones may match
};

// Motions under which many points of a fall onto those of b that they match: distances between
// points are the same in both frames whatever the motion, so that right matches agree with each
// other pair by pair and wrong ones with hardly any. Best first, few. Cost: the square of the
// number of matches, 5 ns each.
std::vector<Rigid3> MotionsOfAgreeingMatches(std::span<const FeatureMatch> matches,
                                             const std::vector<std::optional<StereoPoint>>& of_a,
                                             const std::vector<std::optional<StereoPoint>>& of_b);

// b_from_a that most matches agree with, without any prediction; nothing if fewer than
// min_revisit_inliers do. Equal input gives equal output. Some 5 ms for 1500 features.
std::optional<StereoPose> MotionWithoutPrediction(const SearchedFrame& a, const SearchedFrame& b,
                                                  const StereoRig& rig,
                                                  const MatchingOptions& options);

}  // namespace rigmap
