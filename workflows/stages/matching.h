// The stage `matching`.
#pragma once

#include "features/feature_options.h"
#include "features/feature_store.h"
#include "imaging/mask_options.h"
#include "matching/match_frames.h"
#include "pipeline/stage.h"
#include "scene/dataset.h"

namespace rigmap {

using MatchingStage = Stage<Correspondences, Takes<Dataset, FeatureStore, Odometry>,
                            Reads<MatchingOptions, FeatureOptions, MaskOptions>>;
MatchingStage Matching();

}  // namespace rigmap
