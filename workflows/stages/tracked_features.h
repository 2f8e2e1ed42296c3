// The stages `features` and `odometry` of the technique klt: corners followed from frame to frame.
#pragma once

#include "dataset/dataset_content.h"
#include "features/corner_tracker.h"
#include "workflows/stages/features.h"
#include "workflows/stages/odometry.h"

namespace rigmap {

using TrackedFeaturesStage = Stage<FeatureIndex, Takes<Dataset, DatasetContent>,
                                   Reads<CornerOptions, FeatureOptions, MaskOptions>>;
TrackedFeaturesStage TrackedFeatures();

OdometryStage TrackedOdometry();

}  // namespace rigmap
