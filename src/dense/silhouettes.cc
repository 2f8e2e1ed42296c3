#include "dense/internal/silhouettes.h"

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/statistics.h"
#include "dense/internal/step_windows.h"

namespace rigmap {
namespace {

constexpr double kErrorPx = 0.1;  // of a refined disparity
constexpr int kWindow = 3;
// A mean over n squares has the relative sigma sqrt(2 / n). Of nine pixels a resampled view tells
// as much as of six.
const double kMost = 1.0 + std::sqrt(2.0 / 6.0);
constexpr double kTwice = 2.0;

// The left view less what the right one shows at the disparities, but for what changes slowly.
class Residuals {
 public:
  Residuals(const cv::Mat& left, const cv::Mat& right, const cv::Mat& known)
      : known_(known), columns_(left.size(), CV_32F), rows_(left.size(), CV_32F) {
    left.convertTo(left_, CV_32F);
    right.convertTo(right_, CV_32F);
    for (int row = 0; row < left.rows; ++row) {
      rows_.row(row).setTo(static_cast<float>(row));
      for (int column = 0; column < left.cols; ++column) {
        columns_.at<float>(row, column) = static_cast<float>(column);
      }
    }
  }
  cv::Mat At(const cv::Mat& disparity) const {
    cv::Mat seen;
    cv::remap(right_, seen, columns_ - disparity, rows_, cv::INTER_CUBIC, cv::BORDER_REPLICATE);
    return left_ - seen;
  }
  // Over what is known in a window.
  cv::Mat Mean(const cv::Mat& values, int side_px) const {
    cv::Mat sum, count;
    cv::boxFilter(values.mul(known_), sum, CV_32F, {side_px, side_px});
    cv::boxFilter(known_, count, CV_32F, {side_px, side_px});
    return sum / cv::max(count, 1e-3F);
  }
  cv::Mat GradientSquares() const {
    cv::Mat gradient;
    cv::Sobel(left_, gradient, CV_32F, 1, 0, 1, 0.5);
    return gradient.mul(gradient);
  }

 private:
  cv::Mat known_, left_, right_, columns_, rows_;
};

// Of normal noise the median of the squares is 0.455 times the variance.
double VarianceOf(const cv::Mat& residuals, const cv::Mat& is_known) {
  std::vector<float> squares;
  for (int row = 0; row < residuals.rows; ++row) {
    for (int column = 0; column < residuals.cols; ++column) {
      const float residual = residuals.at<float>(row, column);
      if (is_known.at<uchar>(row, column) != 0) squares.push_back(residual * residual);
    }
  }
  return squares.empty() ? 0.0 : Median(std::move(squares)) / 0.455;
}

}  // namespace

cv::Mat WidenedEdges(const cv::Mat& left, const cv::Mat& right, const cv::Mat& disparity,
                     const DenseOptions& options) {
  constexpr int kSlowlyPx = 31;  // exposures differ, lenses shade
  const cv::Mat is_known = disparity > 0.0F;
  cv::Mat behind = disparity.clone();
  behind.setTo(1e6F, ~is_known);
  const int reach_px = options.block_px / 2 + options.refinement_px / 2;
  cv::erode(behind, behind, cv::Mat::ones(2 * reach_px + 1, 2 * reach_px + 1, CV_8U));
  const cv::Mat is_edge = is_known & (disparity - behind > kDepthStepPx);
  if (cv::countNonZero(is_edge) == 0) return is_edge;

  cv::Mat known;
  is_known.convertTo(known, CV_32F, 1.0 / 255.0);
  const Residuals residuals(left, right, known);
  cv::Mat own = residuals.At(disparity);
  const cv::Mat slow = residuals.Mean(own, kSlowlyPx);
  own -= slow;
  const cv::Mat own2 = residuals.Mean(own.mul(own), kWindow);
  disparity.copyTo(behind, ~is_edge);
  const cv::Mat other = residuals.At(behind) - slow;
  const cv::Mat other2 = residuals.Mean(other.mul(other), kWindow);
  const cv::Mat expected2 =
      VarianceOf(own, is_known) +
      kErrorPx * kErrorPx * residuals.Mean(residuals.GradientSquares(), kWindow);
  return is_edge & ((own2 > kMost * expected2) | (own2 > kTwice * other2));
}

}  // namespace rigmap
