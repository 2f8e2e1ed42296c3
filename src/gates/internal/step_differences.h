// Adjusted against odometric motion, step by step.
#pragma once

#include <algorithm>
#include <vector>

#include "gates/gates.h"

namespace rigmap {

// Of a motion against one that an odometry has measured.
struct MotionDifference {
  double sigmas = 0.0;  // root mean square of all six coordinates
  double distance_m = 0.0;
};

// `covariance`: of the measured one, as a left perturbation.
MotionDifference DifferenceOf(const Rigid3& motion, const Rigid3& measured,
                              const Matrix6d& covariance);

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
