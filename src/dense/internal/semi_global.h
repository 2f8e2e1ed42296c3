// Semi-global matching over eight paths (Hirschmüller 2008).
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>

#include "dense/dense_options.h"
#include "dense/internal/disparity_windows.h"

namespace rigmap {

// Disparities of the left view, CV_16S in steps of 1/16 px; WinnerRow::kNoDisparity where the
// winner is not unique, at the edge of its window, contradicted by the right view, beyond that
// view's edge or above WinnerRow::kMostDisparity. Views CV_8UC1 of equal size, that of the windows.
//
// The cost volume takes two bytes for each pixel and disparity that is searched. Where that is more
// than `volume_bytes`, the image is matched in strips of as many rows as fit: paths from above are
// the same, those from below begin up to kOverlapTiles rows of tiles further down. One thread; the
// result depends on nothing but the arguments.
cv::Mat MatchSemiGlobal(const cv::Mat& left, const cv::Mat& right, const TileWindows& windows,
                        const DenseOptions& options, std::size_t volume_bytes);

inline constexpr int kOverlapTiles = 4;

// At most what MatchSemiGlobal takes, bytes: volumes as asked for, or those of two rows of tiles
// where that is more, and what is kept besides.
std::size_t SemiGlobalBytes(const TileWindows& windows, const DenseOptions& options,
                            std::size_t volume_bytes);

}  // namespace rigmap
