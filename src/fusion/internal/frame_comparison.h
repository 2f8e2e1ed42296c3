// Which frames of a part are compared with which.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "fusion/fusion_options.h"
#include "geometry/rigid3.h"

namespace rigmap {

// Whether their axes differ by at most max_neighbour_angle_deg.
bool FaceAlike(const Rigid3& a, const Rigid3& b, const FusionOptions& options);

// Frames by their index.
struct FrameComparison {
  std::vector<std::size_t> near;     // nearest in place, nearest first
  std::vector<std::size_t> ahead;    // further ones in viewing direction, ever more apart
  std::vector<std::size_t> further;  // beyond the near ones, nearest first, some of them ahead
};

// Of those that look the same way as the reference (max_neighbour_angle_deg), up to `neighbours`,
// `ahead` and kFurther: some seconds of a drive, or of its return to a place.
inline constexpr std::size_t kFurther = 40;
FrameComparison CompareWith(std::size_t reference, std::span<const Rigid3> world_from_left,
                            const FusionOptions& options);

}  // namespace rigmap
