// Semi-global matching as its equations are written, pixel by pixel: what the kernels must equal.
#pragma once

#include <opencv2/core.hpp>

#include "dense/dense_options.h"
#include "dense/internal/disparity_windows.h"

namespace rigmap {

// As MatchSemiGlobal, for images of a few thousand pixels.
cv::Mat MatchByReference(const cv::Mat& left, const cv::Mat& right, const TileWindows& windows,
                         const DenseOptions& options);

}  // namespace rigmap
