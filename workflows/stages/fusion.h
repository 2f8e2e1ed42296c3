// The stage `fusion`: leaves dense.ply.
#pragma once

#include <cstdint>
#include <optional>
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
  int frames = 0;        // with depth
  std::vector<int> frames_left_out;
  // What was asked of a point's sigma; nothing where it was not.
  std::optional<double> max_sigma_m, max_sigma_pct;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(points, voxel_m, frames, frames_left_out, max_sigma_m, max_sigma_pct);
  }
};

using FusionStage = Stage<FusedMap, Takes<Dataset, PosedPart, DepthIndex>, Reads<FusionOptions>>;
FusionStage Fusion();

// Throws UsageError where depth maps of `view_mb` megabytes, of so many frames, cannot be fused
// beside nothing but the program.
void RequireMemoryForFusion(std::size_t frames, double view_mb, const FusionOptions& options,
                            int allowed_mb);

// What the map is made of, and which frames are left out of it.
Report DescribeMap(const FusedMap& map, const Dataset& dataset, const PosedPart& part,
                   const DepthIndex& depths);

// A view, for techniques that make no map.
FusedMap NoMap(const StageContext& context, const PosedPart& part);

}  // namespace rigmap
