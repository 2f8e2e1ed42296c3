// How good a calibration is that nobody has stated the quality of: what the images can check of it
// tells of what they cannot.
#pragma once

#include "scene/calibration.h"

namespace rigmap {

// By which factor the prior's sigmas should be other for what a part says at the correction `now`:
// the variance component of the prior, most probable where the prior as it stands counts like one
// more parameter that is off by one sigma. Of n parameters that the part knows well, all of them
// right, it makes 1 / sqrt(n + 1); near 1 where the part knows none. `inflation` is that of the
// equations (Inflation).
// What a rig file states is never taken to be better than stated. The prior for files that state
// nothing is never widened: it is wide, and an eye that was knocked aside says nothing of lenses.
double PriorScale(const CalibrationVector& now, const CalibrationEquations& equations,
                  double inflation, const CalibrationPrior& prior);

}  // namespace rigmap
