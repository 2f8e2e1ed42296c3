#include "dense/internal/refinement.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "dense/internal/step_windows.h"

namespace rigmap {
namespace {

constexpr float kMostStep = 0.5F;  // px; a matcher is not further off
constexpr float kLeastGradient2 = 1e-3F;
constexpr float kRounding2 = 1.0F / 6.0F;  // of the difference of two grey values, each rounded
// Central differences of a view that holds nothing but noise have half of its variance, and
// residuals of two such views twice as much.
constexpr float kNoiseGradient2 = 0.25F;  // of the residuals' variance
constexpr double kTextureSigmas = 1.0;    // by which texture has to stand out from noise
constexpr float kLeastCount = 9.0F;       // pixels of a window that tell gradients from noise
constexpr double kSmoothings = 2.0;       // before and after the step

// Means over a window of what is known in it.
class WindowMean {
 public:
  WindowMean(const cv::Mat& known, int side_px) : known_(known), side_(side_px, side_px) {
    cv::boxFilter(known_, share_, CV_32F, side_);
    share_ = cv::max(share_, 1e-6F);
  }
  cv::Mat Of(const cv::Mat& values) const {
    cv::Mat mean;
    cv::boxFilter(values.mul(known_), mean, CV_32F, side_);
    return mean / share_;
  }
  // How many pixels are known around each.
  cv::Mat Counts() const { return share_ * static_cast<double>(side_.area()); }

 private:
  cv::Mat known_, share_;
  cv::Size side_;
};

struct Differences {
  cv::Mat residual;  // left less right view, at the disparities
  cv::Mat gradient;  // of the right view along its rows, there
};

Differences Compare(const cv::Mat& left, const cv::Mat& right, const cv::Mat& disparity) {
  cv::Mat right_f, slope, columns(disparity.size(), CV_32F), rows(disparity.size(), CV_32F);
  right.convertTo(right_f, CV_32F);
  cv::Sobel(right_f, slope, CV_32F, 1, 0, 1, 0.5);
  for (int row = 0; row < disparity.rows; ++row) {
    const auto* shift = disparity.ptr<float>(row);
    auto* column_to = columns.ptr<float>(row);
    for (int column = 0; column < disparity.cols; ++column) {
      column_to[column] = static_cast<float>(column) - shift[column];
    }
    rows.row(row).setTo(static_cast<float>(row));
  }
  Differences found;
  cv::remap(right_f, found.residual, columns, rows, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  cv::remap(slope, found.gradient, columns, rows, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  cv::subtract(left, found.residual, found.residual, cv::noArray(), CV_32F);
  return found;
}

// WindowMoments of all pixels.
struct Moments {
  cv::Mat counts, gradient2, product, residual2;
};

Moments MomentsOf(const cv::Mat& disparity, const Differences& differences, int side_px) {
  const auto& [residual, gradient] = differences;
  cv::Mat known;
  cv::Mat(disparity > 0.0F).convertTo(known, CV_32F, 1.0 / 255.0);
  const WindowMean mean(known, side_px);
  // Without the means over the window, since the views may differ in brightness.
  const cv::Mat mean_residual = mean.Of(residual), mean_gradient = mean.Of(gradient);
  return {mean.Counts(), mean.Of(gradient.mul(gradient)) - mean_gradient.mul(mean_gradient),
          mean.Of(gradient.mul(residual)) - mean_gradient.mul(mean_residual),
          mean.Of(residual.mul(residual)) - mean_residual.mul(mean_residual)};
}

// Beside steps of the depth, those of a pixel's own surface.
void ReplaceAtSteps(const StepWindows& windows, Moments& moments) {
  const cv::Mat& reaching = windows.Reaching();
  for (int row = 0; row < reaching.rows; ++row) {
    for (int column = 0; column < reaching.cols; ++column) {
      if (reaching.at<uchar>(row, column) == 0) continue;
      const WindowMoments own = windows.At(row, column);
      const bool is_enough = own.count >= kLeastCount;  // else nothing is known
      moments.counts.at<float>(row, column) = std::max(own.count, 1.0F);
      moments.gradient2.at<float>(row, column) = is_enough ? own.gradient2 : 0.0F;
      moments.product.at<float>(row, column) = own.product;
      moments.residual2.at<float>(row, column) = own.residual2;
    }
  }
}

}  // namespace

RefinedDisparity RefineDisparity(const cv::Mat& left, const cv::Mat& right,
                                 const cv::Mat& disparity, const DenseOptions& options) {
  const int radius_px = options.smoothing_px / 2;
  const cv::Mat coarse = SmoothDisparity(disparity, radius_px);
  const cv::Mat is_known = coarse > 0.0F;
  const Differences differences = Compare(left, right, coarse);
  Moments moments = MomentsOf(coarse, differences, options.refinement_px);
  ReplaceAtSteps({coarse, differences.residual, differences.gradient, options.refinement_px},
                 moments);
  const auto& [counts, variance, product, residual2] = moments;
  const cv::Mat gradient2 = cv::max(variance, kLeastGradient2);
  // A larger disparity looks further left: the view changes by minus the gradient.
  const cv::Mat step = -product / gradient2;
  RefinedDisparity refined;
  refined.disparity = coarse + cv::max(cv::min(step, kMostStep), -kMostStep);
  refined.disparity.setTo(0.0F, ~is_known | (refined.disparity <= 0.0F));
  const cv::Mat unexplained = cv::max(residual2 + step.mul(product), kRounding2);
  // A mean over n squares of noise has the relative sigma sqrt(2 / n).
  const cv::Mat noise_gradient2 = kNoiseGradient2 * unexplained;
  cv::Mat spread;
  cv::sqrt(2.0 / counts, spread);
  const cv::Mat textured = gradient2 > noise_gradient2.mul(1.0 + kTextureSigmas * spread);
  refined.disparity.setTo(0.0F, ~textured);
  refined.disparity = SmoothDisparity(refined.disparity, radius_px);
  const double factor = options.refined_sigma_factor;
  cv::sqrt(factor * factor * unexplained / gradient2 / counts +
               options.least_sigma_px * options.least_sigma_px +
               kSmoothings * SquareBendOf(refined.disparity, radius_px),
           refined.sigma);
  return refined;
}

}  // namespace rigmap
