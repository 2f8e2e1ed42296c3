// Loop closures found by appearance and proved by the geometry of the rig, without the odometry.
#pragma once

#include <functional>
#include <vector>

#include "matching/matching_options.h"
#include "scene/correspondences.h"
#include "scene/odometry.h"
#include "scene/rig.h"

namespace rigmap {

struct LoopClosureSearch {
  const Odometry& odometry;
  // Gives frame i's features. Asked for three times and oftener, by several threads at a time.
  const std::function<FrameFeatures(int frame)>& features;
  // sample_points[i] are some points seen by keyframe i, in its left camera.
  const std::vector<std::vector<Eigen::Vector3d>>& sample_points;
  const StereoRig& rig;
};

// For each keyframe up to max_revisits of the earlier ones that look most like it, among those of
// another stretch of the way (LoopCandidatesBefore), in order of b. Sand looks like sand: each is
// matched without any prediction and counts only if enough matches agree with one motion of the
// rig, that motion is known well enough to predict where things are seen, and a loop closure by
// another keyframe nearby tells of the same motion by way of the odometry, or the matches are so
// many that none need. Holds a few frames and 8 bytes per feature of every keyframe.
std::vector<LoopClosure> FindLoopClosures(const LoopClosureSearch& search,
                                          const MatchingOptions& options);

}  // namespace rigmap
