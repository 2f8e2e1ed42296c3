// How well the metres of a part are known whose images do not check the calibration.
#pragma once

#include "adjustment/adjustment_options.h"
#include "scene/odometry.h"
#include "scene/rig.h"

namespace rigmap {

// Of a path whose steps from keyframe to keyframe were posed with a rig file as it is.
struct UncheckedScale {
  // Relative, of all lengths: by an offset of all disparities, through what that does to the steps,
  // and by the common focal length, which scales all depths. The offset is off by what the prior of
  // the calibration leaves of it and by what the steps ask for, since nothing was corrected.
  double sigma = 0.0;
  double asked_offset_px = 0.0;  // the most probable one, by the steps' residuals and the prior
};
UncheckedScale UncheckedScaleOf(const StereoRig& rig, const Odometry& motion,
                                const AdjustmentOptions& options);

// What of it remains where each image was posed for itself: the common focal length. Lengths
// between the eyes grow with it and lengths along the view do not, so that the metres of a way
// ahead hang on it in full.
double UncheckedFocalSigma(const StereoRig& rig, const AdjustmentOptions& options);

}  // namespace rigmap
