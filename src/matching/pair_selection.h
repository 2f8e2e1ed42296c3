// Which pairs of frames are worth matching.
#pragma once

#include <vector>

#include "matching/matching_options.h"
#include "scene/correspondences.h"
#include "scene/odometry.h"
#include "scene/rig.h"

namespace rigmap {

// Two frames, a < b, of which b is to be matched with a.
struct CandidatePair {
  int a = 0, b = 0;
  bool revisit = false;  // not one of the neighbours in time
};

// For each keyframe the keyframes just before it and revisited ones, nearest first; for every other
// frame the keyframes before and after it. In order of time: each keyframe's pairs are followed by
// those of the frames between the keyframe before and it.
// `sample_points[k]` are some points seen by keyframe k, in its left camera.
std::vector<CandidatePair> SelectPairs(
    const Odometry& odometry, const std::vector<std::vector<Eigen::Vector3d>>& sample_points,
    const StereoRig& rig, const MatchingOptions& options);

}  // namespace rigmap
