// The recipe of `rigmap join`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "workflows/part_options.h"
#include "workflows/stages/inputs.h"
#include "workflows/stages/joined_parts.h"
#include "workflows/stages/satellite_fixes.h"

namespace rigmap {

// All parts in one adjustment: keypoints and depth maps are theirs; the motion across seams,
// correspondences and loop closures over the whole, poses, points and the one rig are found
// together, so that what is unknown of the rig counts once; then one map. With fixes to tie them
// to, the poses are moved towards these before anything is made of them but the verdict.
StageGraph JoinRecipe(const Dataset& dataset, const DatasetContent& content,
                      const JoinedParts& parts, const KnownDepths& depths,
                      const std::optional<SplitFixes>& tie_to, const PartOptions& options);

// In order.
std::vector<std::string> JoinStageNames();

}  // namespace rigmap
