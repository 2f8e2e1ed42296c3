// The near side of steps of the depth, which matching makes too wide.
#pragma once

#include <opencv2/core.hpp>

#include "dense/dense_options.h"

namespace rigmap {

// Where something stands beside something further away and does not look alike in both views, 255
// (CV_8UC1). Within half a block of the matching and half a window of the refinement (`reach`), the
// window around a pixel of the background holds the edge of what is before it, and the pixel is
// given its disparity. The grey values of both views then differ by more, over 3 x 3 pixels, than
// noise and an error of 0.1 px make of them, or by twice what they differ by at the disparity of
// what is behind. Views CV_8UC1, disparities CV_32FC1 with 0 for unknown. Takes 32 bytes per pixel.
cv::Mat WidenedEdges(const cv::Mat& left, const cv::Mat& right, const cv::Mat& disparity,
                     const DenseOptions& options);

}  // namespace rigmap
