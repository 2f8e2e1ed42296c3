// How far a rig file may be off before any image of a part has been seen.
#pragma once

#include "adjustment/adjustment_options.h"
#include "scene/calibration.h"
#include "scene/rig.h"

namespace rigmap {

// What the rig file states; else what options allow each parameter by itself, together with what a
// calibration with a board leaves (BoardCovariance).
CalibrationPrior PriorOf(const StereoRig& rig, const AdjustmentOptions& options);

// Of a correction of the rig, when it was calibrated with a square board that both eyes see in 25
// views, to 1 px: in the middle and towards the corners of the image, facing the camera and tilted,
// near and far. Poses of the board and the baseline are estimated along with 18 parameters; the
// common focal length is held, so that what is not known of it is a figure of its own. No parameter
// has more than ten times its sigma of `alone`.
CalibrationMatrix BoardCovariance(const StereoRig& rig, const CalibrationVector& alone);

}  // namespace rigmap
