// The stage `odometry`.
#pragma once

#include "features/feature_store.h"
#include "odometry/track_frames.h"
#include "pipeline/stage.h"
#include "scene/dataset.h"

namespace rigmap {

using OdometryStage = Stage<Odometry, Takes<Dataset, FeatureStore>, Reads<OdometryOptions>>;
OdometryStage VisualOdometry();

// Poses all frames of the store.
Odometry TrackAll(const Dataset& dataset, const FeatureStore& features,
                  const OdometryOptions& options, MatchBy match_by);

}  // namespace rigmap
