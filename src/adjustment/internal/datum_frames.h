// The datum frame of each group of connected frames.
#pragma once

#include <vector>

#include "scene/adjustment.h"

namespace rigmap {

// For every frame its datum frame, whose pose the adjustment holds: the first frame of its group.
// Frames, and groups of frames, that share six points or more are one group. Two groups lie to each
// other as their starting poses say: no points tell. A frame without points is a group of its own.
std::vector<int> DatumFrames(const std::vector<AdjustedPoint>& points, std::size_t frames);

// Makes a point of each group's own of every one that several groups see. As one point it would
// pull at their datum frames, which are held, as if these had been measured against each other.
void SplitBetweenGroups(std::size_t frames, std::vector<AdjustedPoint>& points);

}  // namespace rigmap
