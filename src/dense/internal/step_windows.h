// Windows around pixels beside a step of the depth, where box means would mix two surfaces.
#pragma once

#include <opencv2/core.hpp>

#include "dense/internal/window_moments.h"

namespace rigmap {

// A matcher is not further off on one surface: what differs by more is two.
inline constexpr float kDepthStepPx = 1.5F;

// Of the pixels that are of one surface with the one in the middle, and not of those right at the
// step, which show both surfaces at once.
class StepWindows {
 public:
  // CV_32FC1, and kept: disparities with 0 for unknown; residuals and gradients at them.
  StepWindows(const cv::Mat& disparity, const cv::Mat& residual, const cv::Mat& gradient,
              int side_px);

  // CV_8UC1: the known pixels whose windows reach over a step.
  const cv::Mat& Reaching() const { return reaching_; }
  WindowMoments At(int row, int column) const;

 private:
  cv::Mat disparity_, residual_, gradient_, reaching_, of_one_surface_;
  int radius_px_;
};

}  // namespace rigmap
