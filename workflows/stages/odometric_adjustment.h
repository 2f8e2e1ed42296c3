// The stage `odometric_adjustment`: a part adjusted from the poses of its odometry, with the rig
// that its images ask for (part_adjuster.h). It needs no mapping, which may be under way meanwhile.
#pragma once

#include "adjustment/adjustment_options.h"
#include "dead_reckoning/dead_reckoning_options.h"
#include "features/corner_tracker.h"
#include "features/feature_options.h"
#include "features/feature_store.h"
#include "imaging/mask_options.h"
#include "matching/matching_options.h"
#include "odometry/odometry_options.h"
#include "pipeline/stage.h"
#include "scene/correspondences.h"
#include "scene/dataset.h"
#include "scene/odometry.h"
#include "workflows/stages/adjusted_part.h"

namespace rigmap {

using OdometricAdjustmentStage =
    Stage<AdjustedPart, Takes<Dataset, FeatureStore, Odometry, Correspondences>,
          Reads<FeatureOptions, CornerOptions, MaskOptions, MatchingOptions, AdjustmentOptions,
                OdometryOptions, DeadReckoningOptions, FilterOptions>>;
OdometricAdjustmentStage OdometricAdjustment();

}  // namespace rigmap
