#include "dense/internal/silhouettes.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/statistics.h"
#include "dense/internal/interpolated_rows.h"
#include "dense/internal/step_windows.h"

namespace rigmap {
namespace {

constexpr double kErrorPx = 0.1;  // of a refined disparity
// A mean over n squares has the relative sigma sqrt(2 / n). Of nine pixels a resampled view tells
// as much as of six.
const double kMost = 1.0 + std::sqrt(2.0 / 6.0);
constexpr double kTwice = 2.0;

// The left view less what the right one shows, at disparities.
class Residuals {
 public:
  Residuals(const cv::Mat& left, const cv::Mat& right) : left_(left), right_(right) {}
  float At(int row, int column, float disparity_px) const {
    return static_cast<float>(left_.at<uchar>(row, column)) -
           right_.At(row, static_cast<float>(column) - disparity_px).Cubic();
  }
  cv::Mat Of(const cv::Mat& disparity) const {
    cv::Mat residuals(disparity.size(), CV_32F);
    for (int row = 0; row < disparity.rows; ++row) {
      const auto* shift = disparity.ptr<float>(row);
      auto* residual = residuals.ptr<float>(row);
      for (int column = 0; column < disparity.cols; ++column) {
        residual[column] = At(row, column, shift[column]);
      }
    }
    return residuals;
  }

 private:
  cv::Mat left_;
  InterpolatedRows right_;
};

// Over what is known around each pixel.
cv::Mat MeanOfKnown(const cv::Mat& values, const cv::Mat& is_known, int side_px) {
  cv::Mat known, sum, count;
  is_known.convertTo(known, CV_32F, 1.0 / 255.0);
  cv::boxFilter(values.mul(known), sum, CV_32F, {side_px, side_px});
  cv::boxFilter(known, count, CV_32F, {side_px, side_px});
  return sum / cv::max(count, 1e-3F);
}

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

// Means over what is known in a window of three by three.
struct WindowMeans {
  float own2 = 0.0F, other2 = 0.0F;  // squares of residuals: at the disparities, and behind them
  float gradient2 = 0.0F;            // of the left view along its rows
};

WindowMeans MeansAround(int row, int column, const cv::Mat& left, const cv::Mat& is_known,
                        const cv::Mat& own, const cv::Mat& other) {
  const cv::Rect window = cv::Rect(column - 1, row - 1, 3, 3) & cv::Rect({}, left.size());
  WindowMeans sum;
  float count = 0.0F;
  for (int y = window.y; y < window.br().y; ++y) {
    const auto *known = is_known.ptr<uchar>(y), *grey = left.ptr<uchar>(y);
    const auto *own_row = own.ptr<float>(y), *other_row = other.ptr<float>(y);
    for (int x = window.x; x < window.br().x; ++x) {
      if (known[x] == 0) continue;
      const float gradient = 0.5F * static_cast<float>(grey[std::min(x + 1, left.cols - 1)] -
                                                       grey[std::max(x - 1, 0)]);
      count += 1.0F;
      sum.own2 += own_row[x] * own_row[x];
      sum.other2 += other_row[x] * other_row[x];
      sum.gradient2 += gradient * gradient;
    }
  }
  return {sum.own2 / count, sum.other2 / count, sum.gradient2 / count};
}

// Where something further away lies within reach of a matched and refined window.
cv::Mat DisparitiesBehind(const cv::Mat& disparity, const cv::Mat& is_known,
                          const DenseOptions& options) {
  constexpr double kBeyond = 1e6;
  const int reach_px = options.block_px / 2 + options.refinement_px / 2;
  cv::Mat behind = disparity.clone();
  behind.setTo(kBeyond, ~is_known);
  cv::erode(behind, behind, cv::Mat::ones(2 * reach_px + 1, 2 * reach_px + 1, CV_8U));
  return behind;
}

}  // namespace

cv::Mat WidenedEdges(const cv::Mat& left, const cv::Mat& right, const cv::Mat& disparity,
                     const DenseOptions& options) {
  constexpr int kSlowlyPx = 31;  // exposures differ, lenses shade
  const cv::Mat is_known = disparity > 0.0F;
  const cv::Mat behind = DisparitiesBehind(disparity, is_known, options);
  cv::Mat is_edge = is_known & (disparity - behind > kDepthStepPx);
  if (cv::countNonZero(is_edge) == 0) return is_edge;

  const auto for_each_edge = [&is_edge](const auto& visit) {
    for (int row = 0; row < is_edge.rows; ++row) {
      for (int column = 0; column < is_edge.cols; ++column) {
        if (is_edge.at<uchar>(row, column) != 0) visit(row, column);
      }
    }
  };
  const Residuals residuals(left, right);
  cv::Mat own = residuals.Of(disparity);
  const cv::Mat slow = MeanOfKnown(own, is_known, kSlowlyPx);
  own -= slow;
  cv::Mat other = own.clone();
  for_each_edge([&](int row, int column) {
    other.at<float>(row, column) =
        residuals.At(row, column, behind.at<float>(row, column)) - slow.at<float>(row, column);
  });
  const double variance = VarianceOf(own, is_known);
  cv::Mat widened(disparity.size(), CV_8UC1, cv::Scalar(0));
  for_each_edge([&](int row, int column) {
    const WindowMeans mean = MeansAround(row, column, left, is_known, own, other);
    const double expected2 = variance + kErrorPx * kErrorPx * mean.gradient2;
    const bool differs = mean.own2 > kMost * expected2 || mean.own2 > kTwice * mean.other2;
    if (differs) widened.at<uchar>(row, column) = 255;
  });
  return widened;
}

}  // namespace rigmap
