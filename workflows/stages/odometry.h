// The stages `odometry` and `bridging`.
#pragma once

#include <filesystem>

#include "dead_reckoning/dead_reckoning_options.h"
#include "features/corner_tracker.h"
#include "features/feature_options.h"
#include "features/feature_store.h"
#include "imaging/mask_options.h"
#include "odometry/track_frames.h"
#include "pipeline/stage.h"
#include "scene/dataset.h"

namespace rigmap {

using OdometryStage = Stage<Odometry, Takes<Dataset, FeatureStore>, Reads<OdometryOptions>>;
OdometryStage VisualOdometry();

// What tells the way where the odometry has lost it.
struct BridgingOptions {
  const FeatureOptions& features;  // of lone images, and of matches of corners in the other eye
  const CornerOptions& corners;
  const MaskOptions& masks;
  const OdometryOptions& odometry;
  const DeadReckoningOptions& rover;
  const FilterOptions& filter;
};
// By corners that are followed (followed_corners.h), by images of which the other eye's is missing
// or cannot be read (lone_views.h), then by wheels and gyro (bridge_gaps.h), last by ground that is
// searched where these put it (searched_ground.h). `rig`: what the odometry was made with.
Odometry Bridged(const Dataset& dataset, const StereoRig& rig, const FeatureStore& features,
                 Odometry odometry, const BridgingOptions& options);

using BridgingStage = Stage<Odometry, Takes<Dataset, FeatureStore, Odometry>,
                            Reads<FeatureOptions, CornerOptions, MaskOptions, OdometryOptions,
                                  DeadReckoningOptions, FilterOptions>>;
BridgingStage Bridging();

// As the stage has left it in a part's folder. Throws DataError (joinable.h).
Odometry ReadJoinableOdometry(const std::filesystem::path& root);

// Poses all frames of the store.
Odometry TrackAll(const Dataset& dataset, const FeatureStore& features,
                  const OdometryOptions& options, MatchBy match_by,
                  const ExpectedMotion& expected = {});

}  // namespace rigmap
