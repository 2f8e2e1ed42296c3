// Which frames hang together.
#pragma once

#include <vector>

#include "scene/adjustment.h"

namespace rigmap {

// For every frame the first of those that it hangs together with: groups of frames that share ten
// points or more, directly or by way of others, are one. Between two groups nothing but their
// starting poses tells how they lie. A frame without points is its own.
std::vector<int> DatumFrames(const std::vector<AdjustedPoint>& points, std::size_t frames);

}  // namespace rigmap
