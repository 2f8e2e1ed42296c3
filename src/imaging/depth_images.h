// Depth maps as images that other programs read.
#pragma once

#include <filesystem>

#include "imaging/depth_map.h"

namespace rigmap {

// <stamp_ns>.tif and <stamp_ns>.sigma.tif in `folder`: CV_32FC1, metres along the axis of the map's
// camera and their standard deviation, NaN where nothing is known or not to a pixel of disparity.
// Throws DataError when one cannot be written.
void WriteDepthImages(const DepthMap& map, const std::filesystem::path& folder);

// camera.json in `folder`: width, height, fx, fy, cx, cy (pixel centres at integers) of the depth
// images, and left_from_depth, nine numbers row by row. Throws DataError.
void WriteDepthCamera(const DepthMap& map, const std::filesystem::path& folder);

}  // namespace rigmap
