// Loop closures as another rig measures them.
#pragma once

#include <vector>

#include "matching/matching_options.h"
#include "scene/correspondences.h"
#include "scene/rig.h"

namespace rigmap {

// The loop closures of matched frames, their motions measured anew with this rig from the matches
// they were proved by: a motion found with another rig errs as that rig does, in the same way
// wherever it is looked at, so that all closures contradict what the right one shows. One whose
// matches agree with no motion of this rig is left out.
std::vector<LoopClosure> LoopClosuresByRig(const Correspondences& matches, const StereoRig& rig,
                                           const MatchingOptions& options);

}  // namespace rigmap
