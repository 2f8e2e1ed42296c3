// COLMAP's models in metres, otherwise as they are.
#pragma once

#include <span>
#include <vector>

#include "scene/adjustment.h"
#include "scene/aligned_keyframes.h"
#include "scene/rig.h"
#include "scene/sparse_model.h"

namespace rigmap {

// The poses of `aligned` and the points of its models that a left image shows, for techniques that
// adjust nothing after the mapping. `frames` holds each keyframe's frame, of `frame_count`;
// observations name keypoints where others name features. Nothing is known of covariances; the
// sigma of the scale is the spread of the left-right distances, of the model where it is worst. The
// reprojection error is COLMAP's own.
Adjustment InMetres(const std::vector<SparseModel>& models, const AlignedKeyframes& aligned,
                    std::span<const int> frames, int frame_count, const StereoRig& rig);

}  // namespace rigmap
