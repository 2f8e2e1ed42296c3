// The stage `adjustment`: leaves trajectories, sparse/ and, where the rig was corrected,
// rig_refined.yaml.
#pragma once

#include <string>
#include <vector>

#include "adjustment/adjust.h"
#include "dataset/dataset_content.h"
#include "dead_reckoning/dead_reckoning_options.h"
#include "features/corner_tracker.h"
#include "features/feature_options.h"
#include "features/feature_store.h"
#include "gates/gates.h"
#include "imaging/mask_options.h"
#include "matching/matching_options.h"
#include "odometry/odometry_options.h"
#include "pipeline/stage.h"
#include "scale/baseline_scale.h"
#include "scene/correspondences.h"
#include "scene/dataset.h"
#include "scene/keyframe_graph.h"
#include "workflows/stages/adjusted_part.h"
#include "workflows/stages/in_turn.h"

namespace rigmap {

// Which poses the adjustment starts from.
enum class StartingFrom { kMapping, kOdometry };
constexpr auto NamesOf(StartingFrom) { return std::array{"mapping", "odometry"}; }

using AdjustmentStage =
    Stage<AdjustedPart,
          Takes<Dataset, DatasetContent, FeatureStore, Odometry, Correspondences, KeyframeGraph,
                AlignedKeyframes>,
          Reads<InTurn<StartingFrom>, FeatureOptions, CornerOptions, MaskOptions, MatchingOptions,
                AdjustmentOptions, OdometryOptions, DeadReckoningOptions, FilterOptions,
                MappingGateOptions, AdjustmentGateOptions>>;
// Where what was mapped fails its gates the adjustment starts from the odometry. Where the images
// correct the rig, the odometry is done anew and loop closures are measured anew with the corrected
// rig, and the adjustment starts from that, since both erred as the wrong rig did. Else, where a
// gate on the adjustment fails, it begins again from the other poses.
AdjustmentStage RigAdjustment();
// For a recipe in which a later stage publishes poses and points.
void PublishCalibrationOnly(AdjustmentStage& stage);

}  // namespace rigmap
