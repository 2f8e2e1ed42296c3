// Depth maps as images that other programs read.
#pragma once

#include <filesystem>

#include "imaging/depth_map.h"

namespace rigmap {

// CV_32FC1: metres along the axis of the map's camera, `unknown` where nothing is known or not to a
// pixel of disparity.
cv::Mat DepthImage(const DepthMap& map, float unknown);

// <stamp_ns>.tif and <stamp_ns>.sigma.tif in `folder`: DepthImage with NaN, and the standard
// deviations of its depths. Throws DataError when one cannot be written.
void WriteDepthImages(const DepthMap& map, const std::filesystem::path& folder);

// camera.json in `folder`: width, height, fx, fy, cx, cy (pixel centres at integers) of the depth
// images, and left_from_depth, nine numbers row by row. Throws DataError.
void WriteDepthCamera(const DepthMap& map, const std::filesystem::path& folder);

}  // namespace rigmap
