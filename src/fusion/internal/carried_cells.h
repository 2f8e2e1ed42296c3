// What the rig carries along in its view: a wheel, a mast, the edge of a hood.
#pragma once

#include <opencv2/core.hpp>
#include <span>

#include "fusion/fusion_options.h"
#include "fusion/internal/view_cache.h"
#include "geometry/rigid3.h"

namespace rigmap {

// Of the rectified left view, CV_8UC1: 255 where what is seen goes along with the rig. There frames
// from further back keep seeing through the place, to ground that is clearly behind it; and it is
// at the same pixels frame after frame, as nothing is that moves by itself. Smooth or dark parts
// have no features to tell it by (features/rig_fixed.h). Asks up to forty frames of the part, in
// cells of eight pixels. Empty where nothing is carried, or too few frames can be asked.
cv::Mat CarriedByTheRig(std::span<const Rigid3> world_from_left, const FusionOptions& options,
                        ViewCache& views);

}  // namespace rigmap
