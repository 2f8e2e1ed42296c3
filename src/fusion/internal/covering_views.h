// Which views a depth map is confirmed by.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "fusion/internal/view_consistency.h"

namespace rigmap {

// Up to `count` of the candidates (frames by their index, nearest first): the nearest half; those
// that show a part of what `own` knows, kLeastPart of it or more, which none that was taken before
// shows; and for what is left over the nearest again. Nearest first. Who drives a curve sees the
// ground beside it twice, from frames that are far apart and with none between that shows it.
// Poses of left cameras, of the same rig as `own`. What hides behind something else counts as
// shown.
inline constexpr double kLeastPart = 0.02;
std::vector<std::size_t> CoveringViews(const DepthView& own,
                                       std::span<const std::size_t> candidates,
                                       std::span<const Rigid3> world_from_left, std::size_t count);

}  // namespace rigmap
