// What neighbouring depth maps say about the points of one.
#pragma once

#include <span>
#include <vector>

#include "fusion/fusion_options.h"
#include "fusion/voxel_grid.h"
#include "imaging/depth_map.h"

namespace rigmap {

struct DepthView {
  DepthMap map;
  Rigid3 world_from_rectified;
};

// The points of `reference` that enough neighbours confirm, each the mean of all agreeing
// measurements weighed by 1 / sigma^2. Left out:
// - points on which fewer than min_views frames agree, or that more frames see through (they see
//   something clearly behind it) than agree;
// - points that an agreeing neighbour sees clearly better (better_view_share): that one gives them.
// Ordered by row and column. Uses all threads; the result does not depend on their number.
std::vector<SurfaceSample> ConfirmedSamples(const DepthView& reference,
                                            std::span<const DepthView* const> neighbours,
                                            const FusionOptions& options);

}  // namespace rigmap
