// Disparities of a rectified pair.
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>

#include "dense/dense_options.h"

namespace rigmap {

// A rectified pair with equal rows and columns: CV_8UC1 views and masks (255 usable).
struct RectifiedPair {
  cv::Mat left, right;
  cv::Mat left_mask, right_mask;
};

// Column in the left view less column in the right, CV_32F, in steps of 1/16 px; 0 where unknown.
// Searched from 0 to `max_disparity_px`, a little beyond as well; method sgm from coarse to fine
// (internal/coarse_to_fine.h), bm over a range narrowed to what a match at a quarter of the
// resolution finds. Left out: masked pixels and those whose stereo match is masked, and what fails
// the checks of `options`. One thread.
cv::Mat MatchDisparity(const RectifiedPair& pair, double max_disparity_px,
                       const DenseOptions& options);

// At most what MatchDisparity takes for views of this size, bytes.
std::size_t MatchingBytes(cv::Size size, double max_disparity_px, const DenseOptions& options);

}  // namespace rigmap
