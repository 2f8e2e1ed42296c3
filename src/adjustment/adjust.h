// The stage `adjustment`: bundle adjustment with one pose per frame and the rig held at its
// calibration.
#pragma once

#include <optional>
#include <vector>

#include "adjustment/adjustment_options.h"
#include "scene/adjustment.h"
#include "scene/correspondences.h"

namespace rigmap {

struct AdjustmentInput {
  const Correspondences& correspondences;
  const StereoRig& rig;
  // Metric starting poses; a frame without one is not adjusted. The first that has one is held, and
  // so is the first of every further group of frames that shares no points with those before.
  std::vector<std::optional<Rigid3>> world_from_left;
  // To start from: which parameters of the rig are corrected, and how far.
  RigRefinement refined = RigRefinement::kNone;
  CalibrationVector correction = CalibrationVector::Zero();
  // A rig that turns out to be wrong need only be corrected roughly: what this rests on is measured
  // anew with it, and adjusted again.
  bool is_provisional = false;
  // Frames, rising, from which on no point ties frames to those before them: they lie to each other
  // as their starting poses say.
  std::vector<int> apart;
  // Per frame, another against which its motion is of interest (Adjustment::link_covariances).
  std::vector<int> references;
};

// In rounds: triangulates all tracks on the poses as they stand, adjusts poses and points together
// and drops outliers (robust loss; equal input gives equal output, whatever the number of threads).
// Frames with too few observations (10) keep no pose.
Adjustment AdjustBundle(const AdjustmentInput& input, const AdjustmentOptions& options);

}  // namespace rigmap
