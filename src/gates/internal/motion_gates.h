// Whether the map's motion and the odometry's are the same, over single steps and long ways.
#pragma once

#include "gates/gates.h"

namespace rigmap {

// motion_agreement_window, _sigmas and _pct: steps by themselves.
void JudgeSteps(const GateInputs& inputs, const AdjustmentGateOptions& options, Gates& gates);

// motion_agreement_drift: ways of 2, 4, 8 and more steps of the odometry's chain. What is off in
// each step by chance averages out, so that of a way the share may be off by as much as of a step
// over the root of their number, but by `accuracy_pct` in any case: small steps aside that all go
// the same way, or turn the same way, are beyond. Of the ways of equal length the median counts,
// so that one wrong length of the odometry passes where the chain is long; a wrong turn, which a
// torn map has as well, does not. The worst number of steps, in limits; a way is as far off as the
// smaller of sigmas and share says. No value where no two steps follow each other.
Gate JudgeDrift(const GateInputs& inputs, const AdjustmentGateOptions& options,
                double accuracy_pct);

}  // namespace rigmap
