// The datum frame of each group of connected frames.
#pragma once

#include <vector>

#include "scene/adjustment.h"

namespace rigmap {

// For every frame its datum frame, whose pose the adjustment holds: the first frame of its group.
// Frames, and groups of frames, that share ten points or more are one group. Two groups lie to each
// other as their starting poses say: no points tell. A frame without points is a group of its own.
std::vector<int> DatumFrames(const std::vector<AdjustedPoint>& points, std::size_t frames);

}  // namespace rigmap
