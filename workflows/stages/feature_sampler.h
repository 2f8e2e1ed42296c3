// Features at pixels that a stage asks for, from the images of a data set.
#pragma once

#include "features/feature_options.h"
#include "features/rig_fixed.h"
#include "imaging/mask_options.h"
#include "scene/dataset.h"
#include "scene/sampled_features.h"

namespace rigmap {

// Parts are joined without their images, too.
bool HasImages(const StereoFrame& frame);

// As `rig` sees them; none in cells of `rig_fixed`. All must outlive it. Reads the images anew for
// each call.
FeatureSampler SamplerOf(const Dataset& dataset, const StereoRig& rig,
                         const RigFixedCells& rig_fixed, const FeatureOptions& options,
                         const MaskOptions& masks);

}  // namespace rigmap
