// Which pixels may be used.
#pragma once

#include <opencv2/core.hpp>

#include "imaging/mask_options.h"
#include "scene/rig.h"

namespace rigmap {

// Masks are CV_8UC1 of the image's size: 255 usable, 0 not.

// What holds for every image of an eye: its calibrated region and its mask file. Throws DataError
// when the mask file cannot be read or is not of the camera's size.
cv::Mat StaticMask(const RigEye& eye);

// 255 where a square of that width, all below the black level, has its place.
cv::Mat BlackAreas(const cv::Mat& grey, const MaskOptions& options, int width_px);

// The static mask without saturated areas (not single glints), without black ones and, if asked
// for, without the sky: a smooth region that hangs from the top border and is clearly brighter than
// the image below. A dark sky and dark or textured walls stay. About 2 ms for 1024 x 768.
cv::Mat UsableMask(const cv::Mat& grey, const cv::Mat& static_mask, const MaskOptions& options);

}  // namespace rigmap
