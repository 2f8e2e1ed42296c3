// The stages `odometry` and `bridging`.
#pragma once

#include <filesystem>

#include "dead_reckoning/dead_reckoning_options.h"
#include "features/feature_store.h"
#include "odometry/track_frames.h"
#include "pipeline/stage.h"
#include "scene/dataset.h"

namespace rigmap {

using OdometryStage = Stage<Odometry, Takes<Dataset, FeatureStore>, Reads<OdometryOptions>>;
OdometryStage VisualOdometry();

using BridgingStage =
    Stage<Odometry, Takes<Dataset, Odometry>, Reads<DeadReckoningOptions, FilterOptions>>;
// The motion by the rover's wheels and gyro where the odometry lost its way (bridge_gaps.h).
BridgingStage Bridging();

// As the stage has left it in a part's folder. Throws DataError (joinable.h).
Odometry ReadJoinableOdometry(const std::filesystem::path& root);

// Poses all frames of the store.
Odometry TrackAll(const Dataset& dataset, const FeatureStore& features,
                  const OdometryOptions& options, MatchBy match_by,
                  const ExpectedMotion& expected = {});

}  // namespace rigmap
