// Which pairs of frames are worth matching.
#pragma once

#include <optional>
#include <vector>

#include "matching/matching_options.h"
#include "scene/correspondences.h"
#include "scene/odometry.h"
#include "scene/rig.h"

namespace rigmap {

// Two frames, a < b, of which b is to be matched with a.
struct CandidatePair {
  int a = 0, b = 0;
  bool loop_closure = false;  // not one of the neighbours in time
  // Of a loop closure that was found by its appearance: what the search found.
  std::optional<Rigid3> b_from_a;
};

// Frames that are keyframes, in order.
std::vector<int> Keyframes(const Odometry& odometry);

// For each keyframe k (index into `keyframes`), how many of the first keyframes were followed by
// one that had hardly anything in view of what k sees, or it of theirs: only those can be
// revisited, all others belong to the same stretch of the way. Never one of the neighbours in time.
std::vector<int> LoopCandidatesBefore(
    const std::vector<int>& keyframes, const Odometry& odometry,
    const std::vector<std::vector<Eigen::Vector3d>>& sample_points, const StereoRig& rig,
    const MatchingOptions& options);

// For each keyframe the keyframes just before it and candidates for loop closures, nearest first;
// for every other frame the keyframes before and after it. In order of time: each keyframe's pairs
// are followed by those of the frames between the keyframe before and it. `sample_points[k]` are
// some points seen by keyframe k, in its left camera.
std::vector<CandidatePair> SelectPairs(
    const Odometry& odometry, const std::vector<std::vector<Eigen::Vector3d>>& sample_points,
    const StereoRig& rig, const MatchingOptions& options);

// Adds what the search by appearance found (LoopClosure::by_appearance) to the pairs of the
// keyframes that they lead to; a pair that is there already only takes the motion.
void AddFoundLoopClosures(const std::vector<LoopClosure>& found, std::vector<CandidatePair>& pairs);

}  // namespace rigmap
