// The stage `odometry`.
#pragma once

#include "features/feature_store.h"
#include "odometry/track_frames.h"
#include "pipeline/stage.h"
#include "scene/dataset.h"

namespace rigmap {

using OdometryStage = Stage<Odometry, Takes<Dataset, FeatureStore>, Reads<OdometryOptions>>;
OdometryStage VisualOdometry();

}  // namespace rigmap
