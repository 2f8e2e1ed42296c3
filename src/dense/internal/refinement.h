// Disparities finer than the steps and the bias of a matcher.
#pragma once

#include <opencv2/core.hpp>

#include "dense/dense_options.h"

namespace rigmap {

struct RefinedDisparity {
  cv::Mat disparity;     // CV_32FC1, px; 0 where unknown
  cv::Mat sigma;         // CV_32FC1, px; one standard deviation of each known disparity
  cv::Mat smoothed_pct;  // CV_8UC1, of its square, in tens: SquareBendOf
};

// What a matcher found is smoothed, brought by one step of least squares (Lucas and Kanade 1981) to
// where the window around each pixel looks alike in both views up to a gain of 1 and an offset, and
// smoothed again; there bends are kept where depth is known to less than the smoothing's window is
// wide (`focal_px` is that of the views). Semi-global matching interpolates costs that are no
// parabolas, which leaves biases of up to 0.03 px and noise of 0.2 px on sand; after this 0.002 and
// 0.08 to 0.15 px are left. Where the texture is hardly above the noise the step is too short, and
// up to half of a bias stays.
//
// Where the window reaches over a step of the depth, only the pixel's own surface in it counts
// (StepWindows).
//
// The sigma is that of the least squares, from gradients and residuals in the window, times
// `refined_sigma_factor`, and at least `least_sigma_px`; and what smoothings that keep no bends may
// have taken off a surface that is no plane within their windows (SquareBendOf). Where the
// gradients do not stand out from what noise alone would make of them nothing is known, and the
// disparity is 0: the matcher has carried over what it found beside. Views CV_8UC1, disparities
// CV_32FC1 with 0 for unknown. Takes 44 bytes per pixel.
RefinedDisparity RefineDisparity(const cv::Mat& left, const cv::Mat& right,
                                 const cv::Mat& disparity, double focal_px,
                                 const DenseOptions& options);

// Each known disparity averaged with those within `radius_px` columns and rows, in pairs opposite
// to each other, so that a slope stays what it is; pairs of which either is unknown or differs from
// the middle by more than a pixel, as across an edge, are left out.
cv::Mat SmoothDisparity(const cv::Mat& disparity, int radius_px);

// The mean of the squares (px2) of how much the means of such pairs differ from the disparity
// between them: 0 on a plane.
cv::Mat SquareBendOf(const cv::Mat& disparity, int radius_px);

}  // namespace rigmap
