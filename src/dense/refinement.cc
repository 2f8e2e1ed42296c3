#include "dense/internal/refinement.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "dense/internal/interpolated_rows.h"
#include "dense/internal/step_windows.h"
#include "dense/internal/window_moments.h"

namespace rigmap {
namespace {

constexpr float kMostStep = 0.5F;  // px; a matcher is not further off
constexpr float kLeastGradient2 = 1e-3F;
constexpr float kRounding2 = 1.0F / 6.0F;  // of the difference of two grey values, each rounded
// Central differences of a view that holds nothing but noise have half of its variance, and
// residuals of two such views twice as much.
constexpr float kNoiseGradient2 = 0.25F;  // of the residuals' variance
constexpr float kTextureSigmas = 1.0F;    // by which texture has to stand out from noise
constexpr float kLeastCount = 9.0F;       // pixels of a window that tell gradients from noise
constexpr double kSmoothings = 2.0;       // before and after the step, where no bend is kept

struct Differences {
  cv::Mat residual;  // left less right view, at the disparities
  cv::Mat gradient;  // of the right view along its rows, there
};

Differences Compare(const cv::Mat& left, const cv::Mat& right, const cv::Mat& disparity) {
  const InterpolatedRows shown(right);
  Differences found{cv::Mat(disparity.size(), CV_32F), cv::Mat(disparity.size(), CV_32F)};
  for (int row = 0; row < disparity.rows; ++row) {
    const auto* own = left.ptr<uchar>(row);
    const auto* shift = disparity.ptr<float>(row);
    auto *residual = found.residual.ptr<float>(row), *gradient = found.gradient.ptr<float>(row);
    for (int column = 0; column < disparity.cols; ++column) {
      const RowSamples there = shown.At(row, static_cast<float>(column) - shift[column]);
      residual[column] = static_cast<float>(own[column]) - there.Linear();
      gradient[column] = there.Gradient();
    }
  }
  return found;
}

// Beside steps of the depth, those of a pixel's own surface.
void ReplaceAtSteps(const StepWindows& windows, MomentMaps& moments) {
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

// The least squares of a window: by how much its middle is off, and what that leaves.
struct LeastSquares {
  float gradient2 = 0.0F, step_px = 0.0F, unexplained2 = 0.0F;
};

LeastSquares Solve(float gradient2, float product, float residual2) {
  LeastSquares found{.gradient2 = std::max(gradient2, kLeastGradient2)};
  // A larger disparity looks further left: the view changes by minus the gradient.
  found.step_px = -product / found.gradient2;
  found.unexplained2 = std::max(residual2 + found.step_px * product, kRounding2);
  return found;
}

// Whether texture stands out from what noise makes of gradients.
bool IsTextured(const LeastSquares& found, float count) {
  // A mean over n squares of noise has the relative sigma sqrt(2 / n).
  const float most = 1.0F + kTextureSigmas * std::sqrt(2.0F / count);
  return found.gradient2 > kNoiseGradient2 * found.unexplained2 * most;
}

// Where the least squares lead, 0 where nothing is known, and their variance, px2.
struct Finer {
  cv::Mat disparity, variance;
};

Finer TakeSteps(const cv::Mat& coarse, const MomentMaps& moments, const DenseOptions& options) {
  const auto factor = static_cast<float>(options.refined_sigma_factor),
             least = static_cast<float>(options.least_sigma_px);
  Finer finer{cv::Mat(coarse.size(), CV_32F), cv::Mat(coarse.size(), CV_32F)};
  for (int row = 0; row < coarse.rows; ++row) {
    const auto *from = coarse.ptr<float>(row), *count = moments.counts.ptr<float>(row);
    const auto *gradient2 = moments.gradient2.ptr<float>(row),
               *product = moments.product.ptr<float>(row),
               *residual2 = moments.residual2.ptr<float>(row);
    auto *to = finer.disparity.ptr<float>(row), *variance = finer.variance.ptr<float>(row);
    for (int x = 0; x < coarse.cols; ++x) {
      const LeastSquares found = Solve(gradient2[x], product[x], residual2[x]);
      const float moved = from[x] + std::clamp(found.step_px, -kMostStep, kMostStep);
      const bool is_known = from[x] > 0.0F && moved > 0.0F && IsTextured(found, count[x]);
      to[x] = is_known ? moved : 0.0F;
      const float of_mean = found.unexplained2 / (found.gradient2 * count[x]);
      variance[x] = factor * factor * of_mean + least * least;
    }
  }
  return finer;
}

// What one step of least squares makes of coarse disparities.
Finer Refine(const cv::Mat& left, const cv::Mat& right, const cv::Mat& coarse,
             const DenseOptions& options) {
  const auto [residual, gradient] = Compare(left, right, coarse);
  MomentMaps moments = MomentsOf(coarse > 0.0F, residual, gradient, options.refinement_px);
  ReplaceAtSteps({coarse, residual, gradient, options.refinement_px}, moments);
  return TakeSteps(coarse, moments, options);
}

// How much of a bend is worth keeping, from 0 to 1: all where one sigma of a depth is no longer
// than half of what the mean's window is wide there, nothing from its whole width on. What is known
// less well goes into cubes that are wider than a bend within the window, and would have nothing of
// it but its noise.
cv::Mat ShareOfBends(const Finer& finer, double focal_px, int window_px) {
  cv::Mat share;
  cv::sqrt(finer.variance, share);
  // A depth's relative sigma is that of its disparity, and the window's width there its pixels over
  // the focal length.
  cv::divide(share, finer.disparity, share, -2.0 * focal_px / window_px);
  share = cv::max(cv::min(2.0 + share, 1.0), 0.0);
  share.setTo(0.0, finer.disparity <= 0.0F);
  return share;
}

// A mean; where bends are kept twice a narrower one less the mean of that, which puts back what it
// takes off.
cv::Mat SmoothButBends(const cv::Mat& disparity, const cv::Mat& share, int radius_px) {
  const int narrower_px = std::max(radius_px - 1, 0);
  const cv::Mat wide = SmoothDisparity(disparity, radius_px);
  if (cv::countNonZero(share) == 0) return wide;
  cv::Mat kept = SmoothDisparity(disparity, narrower_px);
  kept = 2.0 * kept - SmoothDisparity(kept, narrower_px) - wide;
  cv::multiply(kept, share, kept);
  return wide + kept;
}

}  // namespace

RefinedDisparity RefineDisparity(const cv::Mat& left, const cv::Mat& right,
                                 const cv::Mat& disparity, double focal_px,
                                 const DenseOptions& options) {
  const int radius_px = options.smoothing_px / 2;
  const Finer finer = Refine(left, right, SmoothDisparity(disparity, radius_px), options);
  const cv::Mat bends = options.keep_bends ? ShareOfBends(finer, focal_px, options.smoothing_px)
                                           : cv::Mat(disparity.size(), CV_32F, cv::Scalar(0.0));
  RefinedDisparity refined{.disparity = SmoothButBends(finer.disparity, bends, radius_px)};
  const cv::Mat smoothed2 = (kSmoothings - bends).mul(SquareBendOf(refined.disparity, radius_px));
  const cv::Mat variance = finer.variance + smoothed2;
  cv::sqrt(variance, refined.sigma);
  // Stored in single per cents it would be a sixth of a depth map's bytes.
  cv::divide(smoothed2, variance, refined.smoothed_pct, 10.0, CV_8U);
  refined.smoothed_pct *= 10;
  return refined;
}

}  // namespace rigmap
