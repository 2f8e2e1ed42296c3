// Disparities of a rectified pair.
#pragma once

#include <opencv2/core.hpp>

#include "dense/dense_options.h"

namespace rigmap {

// A rectified pair with equal rows and columns: CV_8UC1 views and masks (255 usable).
struct RectifiedPair {
  cv::Mat left, right;
  cv::Mat left_mask, right_mask;
};

// Column in the left view less column in the right, CV_32F, in steps of 1/16 px; 0 where unknown.
// Searched from 0 to `max_disparity_px`, which is narrowed to what a match at a quarter of the
// resolution finds. Left out: masked pixels and those whose stereo match is masked, and what fails
// the checks of `options`. Method sgm needs 4 bytes per usable pixel and disparity, and one thread.
cv::Mat MatchDisparity(const RectifiedPair& pair, double max_disparity_px,
                       const DenseOptions& options);

}  // namespace rigmap
