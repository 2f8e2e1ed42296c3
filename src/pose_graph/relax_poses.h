// Starting poses freed of their drift, before points are triangulated on them.
#pragma once

#include <optional>
#include <vector>

#include "scene/correspondences.h"
#include "scene/odometry.h"

namespace rigmap {

// The poses on which each step from a frame's reference (as the odometry has it) keeps its starting
// motion as well as may be, and each loop closure shows its own: least squares, the first pose of
// every connected group held (Ceres, sparse, one thread: equal input gives equal output).
//
// A loop closure may be wrong: it pulls under Cauchy's loss, and one that is far off the solution,
// four sigmas of what the steps in between may have drifted or five of its own, is left out of the
// last one, so that it moves nothing. Poses come back unchanged where all loop closures agree from
// the start or none is believed; frames without a pose keep none.
std::vector<std::optional<Rigid3>> RelaxPoses(
    const std::vector<std::optional<Rigid3>>& world_from_left, const Odometry& odometry,
    const std::vector<LoopClosure>& loop_closures);

// The same for groups of frames, each of which is rigid and keeps its shape: `group` names that of
// each frame that has a pose. What ties frames within a group counts for nothing.
std::vector<std::optional<Rigid3>> RelaxGroups(
    const std::vector<std::optional<Rigid3>>& world_from_left, const std::vector<int>& group,
    const Odometry& odometry, const std::vector<LoopClosure>& loop_closures);

// Takes out the loop closures that are five of their sigmas or more off these poses, and returns
// them: wrong ones, where an adjustment has found that all else contradicts them.
std::vector<LoopClosure> TakeContradicted(const std::vector<std::optional<Rigid3>>& world_from_left,
                                          const Odometry& odometry,
                                          std::vector<LoopClosure>& loop_closures);

}  // namespace rigmap
