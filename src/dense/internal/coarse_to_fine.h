// Semi-global matching, each tile of the image searched only where half the resolution found
// something.
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>

#include "dense/dense_options.h"

namespace rigmap {

// Disparities of the left view from 0 to `range_px`, at most 2046 px, CV_16S in steps of 1/16 px,
// negative where unknown (semi_global.h); freed from single errors by a median over 3 x 3 px and
// from speckles.
//
// The whole range is searched where that takes no more than kWholeSearch disparities for each pixel
// of `left`, at half, a quarter, ... of the resolution. From there each level gives the windows of
// the next: on the ground 32 disparities and hardly more, whatever the range.
cv::Mat MatchCoarseToFine(const cv::Mat& left, const cv::Mat& right, double range_px,
                          const DenseOptions& options);

// As many take as long as the search in windows, and somewhat less memory than it may take.
inline constexpr double kWholeSearch = 40.0;

// At most what MatchCoarseToFine takes, bytes. Of that the cost volumes are 96 bytes a pixel, or
// more only where two rows of tiles searched over the whole range need it.
std::size_t CoarseToFineBytes(cv::Size size, double range_px, const DenseOptions& options);

}  // namespace rigmap
