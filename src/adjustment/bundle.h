// One least-squares problem over poses and points. Of this room only.
#pragma once

#include <optional>
#include <vector>

#include "adjustment/adjusted_points.h"
#include "adjustment/adjustment_options.h"
#include "scene/rig.h"

namespace rigmap {

struct Bundle {
  StereoRig rig;  // its right_from_left as adjusted
  std::vector<std::optional<Rigid3>> left_from_world;
  std::vector<AdjustedPoint> points;  // observed by frames that have a pose
};

// Moves poses and points, and right_from_left if it is to be refined, to the least sum of Huber's
// loss over all observations. Anchors (AnchorFrames) are held. `calibrated` is what the prior draws
// right_from_left to; `noise_px` the sigma of a pixel coordinate.
void SolveBundle(const Rigid3& calibrated, double noise_px, const AdjustmentOptions& options,
                 Bundle& bundle);

}  // namespace rigmap
