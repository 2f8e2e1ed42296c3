// The stage `mapping`: COLMAP poses the keyframes. Leaves colmap/models.
#pragma once

#include "adjustment/adjust_without_rig.h"
#include "mapping/map_keyframes.h"
#include "matching/matching_options.h"
#include "pipeline/stage.h"
#include "scale/baseline_scale.h"
#include "workflows/stages/database.h"

namespace rigmap {

// Fewer keyframes than this are not mapped: the odometric poses are all there is.
inline constexpr std::size_t kMinMappedKeyframes = 3;

// The models with the distances between left and right cameras in them, by which they are judged
// and which `scale` turns into metres.
struct MeasuredModels {
  MappingResult mapped;
  ModelScales scales;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(mapped, scales);
  }
};

using MappingStage =
    Stage<MeasuredModels,
          Takes<ColmapInstallation, Dataset, Odometry, Correspondences, KeyframeGraph>,
          Reads<MappingOptions, VerificationOptions, ScaleOptions>>;
MappingStage Mapping();

// world_from_left of the graph's keyframes by the odometry.
std::vector<Rigid3> OdometricPoses(const Odometry& odometry, const KeyframeGraph& graph);

}  // namespace rigmap
