// Groups of frames that the adjustment does not tie to each other, kept where they lay.
#pragma once

#include <optional>
#include <vector>

#include "geometry/rigid3.h"
#include "scene/adjustment.h"

namespace rigmap {

// The adjustment holds the first frame of each group (Adjustment::datum_frames) where it started,
// while the groups before move away. Every group but the first is moved as a whole, frames and
// points, so that its first frame lies to the frame posed before it as it did in `start`, the
// world_from_left of the frames that were adjusted, in the same gauge.
void CarryGroupsAlong(const std::vector<std::optional<Rigid3>>& start, Adjustment& adjustment);

}  // namespace rigmap
