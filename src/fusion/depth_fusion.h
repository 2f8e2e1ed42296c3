// One coloured surface from posed depth maps.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "fusion/fusion_options.h"
#include "geometry/rigid3.h"
#include "scene/point_cloud.h"

namespace rigmap {

// A depth map as SaveDepth left it, and where it was taken from.
struct PosedDepth {
  std::filesystem::path path;
  std::string key;
  Rigid3 world_from_left;
};

struct FusionTarget {
  std::filesystem::path scratch;  // a folder that may be made, emptied and removed
  std::function<void(std::span<const SurfacePoint>)> take;  // called for piece after piece
};

// Each depth map is compared with others, and what they confirm (view_consistency.h) is averaged on
// a grid of `voxel_m`, finer on what is steeper than 45 degrees (world's z being up) and coarser
// where less is known (layered_grid.h). One point per voxel; normals point to the cameras. The
// order of the frames changes places by rounding only, the number of threads nothing at all.
//
// A single depth map is there as a whole, a point for each pixel that max_incidence_deg and
// max_sigma_m leave, as large as what the pixel covers: nothing is averaged, and max_sigma_pct does
// not apply.
//
// A frame is left out, and its index returned, if it agrees with its neighbours on less than half
// of the pixels on which they agree with theirs: its pose or its depth is wrong. What the rig
// carries along in its view (carried_cells.h) is no surface. Colours are made as bright as those of
// the frames before, where the same ground is seen, and a shadow that came over it since is taken
// away (past_light.h).
//
// Holds `cached_views` depth maps (11 bytes a pixel), but at least those that one is compared with,
// kKeptVoxels voxels and the samples of some rows (together kFusionMegabytes), whatever the number
// of frames. With kCachedViews hardly one is read twice. Throws DataError when a depth map is
// missing or `scratch` cannot be written, UsageError for invalid options.
inline constexpr std::size_t kCachedViews = 40;
inline constexpr std::size_t kKeptVoxels = 2'000'000;
inline constexpr double kFusionMegabytes = 300.0;
std::vector<std::size_t> FuseDepthMaps(std::span<const PosedDepth> depths, double voxel_m,
                                       const FusionOptions& options, const FusionTarget& target,
                                       std::size_t cached_views = kCachedViews);

}  // namespace rigmap
