// One coloured surface from posed depth maps.
#pragma once

#include <filesystem>
#include <span>
#include <string>

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

// Each depth map is compared with its neighbours, and what they confirm is averaged on a grid. One
// point per voxel, ordered by voxel; normals point to the cameras. The order of the frames changes
// the result by rounding only, the number of threads not at all.
//
// Holds neighbours + 1 depth maps and one grid cell per voxel of the result. Throws DataError when
// a depth map is missing, UsageError for invalid options.
PointCloud FuseDepthMaps(std::span<const PosedDepth> depths, const FusionOptions& options);

}  // namespace rigmap
