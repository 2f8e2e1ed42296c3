// A small metric model for COLMAP's mapper to start from.
#pragma once

#include <optional>
#include <vector>

#include "scene/keyframe_graph.h"
#include "scene/rig.h"
#include "scene/sparse_model.h"

namespace rigmap {

struct GraphWithPoses {
  const KeyframeGraph& graph;
  const Correspondences& correspondences;
  const StereoRig& rig;
  std::vector<Rigid3> world_from_left;  // per keyframe, metres
};

// First of `length` keyframes in a row, all of them in `allowed`, that share the most tracks;
// nothing if no such row shares enough to start from (30).
std::optional<int> BestSeedStart(const KeyframeGraph& graph, const std::vector<bool>& allowed,
                                 int length);

// The keyframes first to first + length - 1 with all their keypoints and the tracks that at least
// two of the images see, triangulated on the given poses. Keypoints are numbered as in the
// database.
SparseModel MakeSeedModel(const GraphWithPoses& input, int first, int length);

}  // namespace rigmap
