// Normal equations of a correction of the rig under its prior. Of this room only.
#pragma once

#include <Eigen/Cholesky>

#include "scene/calibration.h"

namespace rigmap {

struct CalibrationSystem {
  CalibrationMatrix matrix;
  CalibrationVector right_side;

  CalibrationVector Solution() const { return matrix.ldlt().solve(right_side); }
};

// Focal lengths and their ratio err with a heavy tail: files are of another camera's, or of another
// focus, and make pixels that are square differ by half a per cent.
// Student's t with three degrees of freedom about `now`: within a sigma as it is, far out it hardly
// pulls.
CalibrationMatrix HeavyTailed(const CalibrationPrior& prior, const CalibrationVector& now);

}  // namespace rigmap
