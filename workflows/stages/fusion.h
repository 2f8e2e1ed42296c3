// The stage `fusion`: leaves dense.ply.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "fusion/fusion_options.h"
#include "pipeline/stage.h"
#include "workflows/stages/dense.h"

namespace rigmap {

// What is kept of the map beside the map itself.
struct FusedMap {
  std::uint64_t points = 0;
  double voxel_m = 0.0;  // of the finest
  std::vector<int> frames_left_out;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(points, voxel_m, frames_left_out);
  }
};

using FusionStage = Stage<FusedMap, Takes<Dataset, PosedPart, DepthIndex>, Reads<FusionOptions>>;
FusionStage Fusion();

// Throws UsageError where depth maps of `view_mb` megabytes, of so many frames, cannot be fused
// beside nothing but the program.
void RequireMemoryForFusion(std::size_t frames, double view_mb, const FusionOptions& options,
                            int allowed_mb);

// A view, for techniques that make no map.
FusedMap NoMap(const StageContext& context, const PosedPart& part);

}  // namespace rigmap
