#include "dense/internal/step_windows.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace rigmap {
namespace {

constexpr float kSameSurfacePx = 1.0F;  // as in SmoothDisparity

// Known pixels around which known disparities differ by more than a step.
cv::Mat NearSteps(const cv::Mat& disparity, const cv::Mat& is_known, int side_px) {
  constexpr float kBeyond = 1e6F;
  const cv::Mat window = cv::Mat::ones(side_px, side_px, CV_8U);
  cv::Mat least = disparity.clone(), most;
  least.setTo(kBeyond, ~is_known);
  cv::erode(least, least, window);
  cv::dilate(disparity, most, window);
  return is_known & (most - least > kDepthStepPx);
}

}  // namespace

StepWindows::StepWindows(const cv::Mat& disparity, const cv::Mat& residual, const cv::Mat& gradient,
                         int side_px)
    : disparity_(disparity), residual_(residual), gradient_(gradient), radius_px_(side_px / 2) {
  const cv::Mat is_known = disparity > 0.0F;
  reaching_ = NearSteps(disparity, is_known, side_px);
  of_one_surface_ = is_known & ~NearSteps(disparity, is_known, 3);
}

WindowMoments StepWindows::At(int row, int column) const {
  const float here = disparity_.at<float>(row, column);
  const int first = std::max(column - radius_px_, 0),
            last = std::min(column + radius_px_, disparity_.cols - 1);
  WindowMoments sum;
  float gradients = 0.0F, residuals = 0.0F;
  for (int y = std::max(row - radius_px_, 0); y <= std::min(row + radius_px_, disparity_.rows - 1);
       ++y) {
    const auto* counts = of_one_surface_.ptr<uchar>(y);
    const auto *disparity = disparity_.ptr<float>(y), *gradient = gradient_.ptr<float>(y),
               *residual = residual_.ptr<float>(y);
    for (int x = first; x <= last; ++x) {
      if (counts[x] == 0 || std::abs(disparity[x] - here) > kSameSurfacePx) continue;
      sum.count += 1.0F;
      gradients += gradient[x];
      residuals += residual[x];
      sum.gradient2 += gradient[x] * gradient[x];
      sum.product += gradient[x] * residual[x];
      sum.residual2 += residual[x] * residual[x];
    }
  }
  if (sum.count == 0.0F) return {};
  gradients /= sum.count;
  residuals /= sum.count;
  return {sum.count, sum.gradient2 / sum.count - gradients * gradients,
          sum.product / sum.count - gradients * residuals,
          sum.residual2 / sum.count - residuals * residuals};
}

}  // namespace rigmap
