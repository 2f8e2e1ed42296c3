// What an adjustment would be if windows drifted. Of this room only.
#pragma once

#include <vector>

#include "adjustment/adjustment_options.h"
#include "adjustment/internal/reduced_system.h"

namespace rigmap {

struct DriftEffect {
  // Per frame, of world_from_left: translation (m), then rotation (rad), in world axes.
  std::vector<Vector6d> poses;
  CalibrationVector calibration = CalibrationVector::Zero();
  double scale = 0.0;  // of the positions about their mean, as a share
};

// Of the squares of an effect, what counts in sigmas: windows may drift or not, or be anywhere
// between, and this is the mean square of what lies anywhere between nothing and one.
inline constexpr double kShareOfDrift = 1.0 / 3.0;

// By how much the poses, and the calibration with the parameters of `refined` free, would move from
// `at`, where `equations` hold, if each point's windows slid over the ground as its view changes.
// Residuals go together along tracks because they do, and as long as they are taken for
// independent, what a track says of its point's depth goes together with what it says of the
// motion: a bias that does not become less with the number of tracks. No poses where the system is
// singular.
DriftEffect EffectOfDrift(Linearisation at, const CalibrationEquations& equations,
                          RigRefinement refined, const CalibrationVector& correction,
                          const CalibrationPrior& prior, const AdjustmentOptions& options);

}  // namespace rigmap
