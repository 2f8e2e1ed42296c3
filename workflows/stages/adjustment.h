// The stage `adjustment`: leaves trajectories, sparse/ and, where the rig was corrected,
// rig_refined.yaml.
#pragma once

#include <string>
#include <vector>

#include "adjustment/adjustment_options.h"
#include "core/enum_names.h"
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

namespace rigmap {

// Which poses the adjustment starts from.
enum class StartingFrom { kMapping, kOdometry };
constexpr auto NamesOf(StartingFrom) { return std::array{"mapping", "odometry"}; }
inline std::string OptionsText(StartingFrom from) { return NameOf(from); }

using AdjustmentStage =
    Stage<AdjustedPart,
          Takes<Dataset, DatasetContent, FeatureStore, Odometry, Correspondences, KeyframeGraph,
                AlignedKeyframes, AdjustedPart>,
          Reads<StartingFrom, FeatureOptions, CornerOptions, MaskOptions, MatchingOptions,
                AdjustmentOptions, OdometryOptions, DeadReckoningOptions, FilterOptions,
                MappingGateOptions, AdjustmentGateOptions>>;
// What was adjusted from the odometry, where that is planned, where what was mapped fails its gates
// and where the images corrected the rig: a mapping with the wrong one errs as that does. Else
// adjusted from the mapped poses. Where the one fails a gate on the adjustment, the other is taken
// if it passes.
AdjustmentStage RigAdjustment();
// For a recipe in which a later stage publishes poses and points.
void PublishCalibrationOnly(AdjustmentStage& stage);

}  // namespace rigmap
