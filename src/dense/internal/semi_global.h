// Semi-global matching over eight paths (Hirschmueller 2008).
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>

#include "dense/dense_options.h"
#include "dense/internal/disparity_windows.h"

namespace rigmap {

// Disparities of the left view, CV_16S in steps of 1/16 px, negative where not sure
// (WinnerRow::kNoDisparity): a winner that is not unique, at the edge of its window, contradicted
// by the right view, or beyond that view's edge. Views CV_8UC1 of equal size, that of the windows.
//
// Takes two bytes for each pixel and disparity that is searched. Where that is more than
// `most_bytes`, the image is matched in strips of as many rows as fit: paths from above are the
// same, those from below begin kOverlapRows further down. One thread; the result depends on
// nothing but the arguments.
cv::Mat MatchSemiGlobal(const cv::Mat& left, const cv::Mat& right, const TileWindows& windows,
                        const DenseOptions& options);

}  // namespace rigmap
