// What least squares need of the windows around the pixels of a view.
#pragma once

#include <opencv2/core.hpp>

namespace rigmap {

// Over the pixels of a window. The views may differ in brightness, so that means are left out.
struct WindowMoments {
  float count = 0.0F;                      // pixels
  float gradient2 = 0.0F;                  // variance of the gradients
  float product = 0.0F, residual2 = 0.0F;  // covariance with the residuals; their variance
};

// The same of all pixels, each CV_32FC1.
struct MomentMaps {
  cv::Mat counts, gradient2, product, residual2;
};

// Of the known pixels (not 0 in CV_8UC1) in a window of `side_px` columns and rows, as far as it
// lies within the image; a count of 1 and else 0 where there is none. Residuals and gradients
// CV_32FC1.
MomentMaps MomentsOf(const cv::Mat& is_known, const cv::Mat& residual, const cv::Mat& gradient,
                     int side_px);

}  // namespace rigmap
