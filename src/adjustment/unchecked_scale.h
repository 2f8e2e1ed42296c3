// How well the metres of a part are known whose images do not check the calibration.
#pragma once

#include <vector>

#include "adjustment/adjustment_options.h"
#include "scene/rig.h"

namespace rigmap {

// Relative sigma of all lengths that the prior of the calibration leaves: an offset of all
// disparities, over the disparity of the middle of what is seen, and the common focal length, which
// scales all depths. `depths_m` of stereo points; zero without any. What an adjustment would find
// out of the calibration is not counted.
double UncheckedScaleSigma(const StereoRig& rig, std::vector<double> depths_m,
                           const AdjustmentOptions& options);

// What of it remains where each image was posed for itself: the common focal length. Lengths
// between the eyes grow with it and lengths along the view do not, so that the metres of a way
// ahead hang on it in full.
double UncheckedFocalSigma(const StereoRig& rig, const AdjustmentOptions& options);

}  // namespace rigmap
