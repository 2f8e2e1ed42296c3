// Adjusted against odometric motion, step by step.
#pragma once

#include <algorithm>
#include <vector>

#include "gates/gates.h"

namespace rigmap {

struct StepDifference {
  int frame = 0;  // at the end of the step, which begins at its reference
  double sigmas = 0.0, pct = 0.0;

  // In limits; a step is as far off as the smaller of the two says.
  double Excess(const AdjustmentGateOptions& options) const {
    return std::min(sigmas / options.motion_agreement_sigmas, pct / options.motion_agreement_pct);
  }
};

// Of every adjusted frame that the odometry measured against a moving reference.
std::vector<StepDifference> StepDifferences(const GateInputs& inputs);

}  // namespace rigmap
