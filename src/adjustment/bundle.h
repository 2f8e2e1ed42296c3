// One least-squares problem over poses and points. Of this room only.
#pragma once

#include <optional>
#include <vector>

#include "adjustment/adjustment_options.h"
#include "scene/adjustment.h"

namespace rigmap {

struct Bundle {
  StereoRig rig;
  std::vector<std::optional<Rigid3>> left_from_world;
  std::vector<AdjustedPoint> points;  // observed by frames that have a pose
};

// Moves poses and points to the least sum of Huber's loss over all observations. Anchors
// (AnchorFrames) and the rig are held. `noise_px` is the sigma of a pixel coordinate.
void SolveBundle(double noise_px, const AdjustmentOptions& options, Bundle& bundle);

// Distance (px) of each observation from its point's image, point by point; infinite behind an eye.
std::vector<double> ErrorsPx(const Bundle& bundle);

// Drops observations beyond the limit, given ErrorsPx, then points that fewer than two frames still
// show.
void DropBeyond(double limit_px, const std::vector<double>& errors_px, Bundle& bundle);

std::vector<int> ObservationsPerFrame(const Bundle& bundle);

}  // namespace rigmap
