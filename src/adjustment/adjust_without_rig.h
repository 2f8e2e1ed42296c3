// Bundle adjustment that does not know of the rig.
#pragma once

#include "adjustment/adjustment_options.h"
#include "scene/rig.h"
#include "scene/sparse_model.h"

namespace rigmap {

// Moves images and points of the model, every image by itself, to the least reprojection error. In
// a model that was made on the poses of a rig all left-right distances are equal by construction;
// after this, their spread says how well its images agree with those poses. Drops observations
// beyond the outlier limit, points that less than two images show, and both images of a keyframe
// of which one shows fewer than `min_observations` points.
SparseModel AdjustWithoutRig(const SparseModel& model, const StereoRig& rig, int min_observations,
                             const AdjustmentOptions& options);

}  // namespace rigmap
