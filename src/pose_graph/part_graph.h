// The pose graph of one part.
#pragma once

#include <optional>
#include <vector>

#include "scene/correspondences.h"
#include "scene/odometry.h"
#include "scene/pose_graph.h"

namespace rigmap {

struct PartGraph {
  PoseGraph graph;
  std::vector<int> frames;  // per node, the frame that it is
};

// A node for every frame with a pose, in order of frames. An odometry edge from each frame to the
// last one before it, in the chain of references, that has a pose: it keeps the motion of the poses
// given, with the chain's covariance and a share for drift. Where `adjusted_steps` (per frame, as
// OdometryFrame::step_covariance is) has a covariance of a single step it counts instead: an
// adjustment that has used the loop closures, too, leaves little for them to pull at. An edge for
// each loop closure between posed frames, its covariance inflated.
PartGraph BuildPartGraph(const std::vector<std::optional<Rigid3>>& world_from_left,
                         const Odometry& odometry, const std::vector<LoopClosure>& loop_closures,
                         const std::vector<std::optional<Matrix6d>>& adjusted_steps = {});

}  // namespace rigmap
