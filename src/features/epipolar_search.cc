#include "features/internal/epipolar_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "features/epipolar_search.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef RIGMAP_FEATURES_EPIPOLAR_SEARCH
#define RIGMAP_FEATURES_EPIPOLAR_SEARCH
namespace rigmap {

constexpr int kWindowRadius = 4;  // 9 x 9 pixels of the reduced image
constexpr int kWindowSize = 2 * kWindowRadius + 1;
constexpr int kPaddedSize = 16;  // of a window's row

}  // namespace rigmap
#endif

HWY_BEFORE_NAMESPACE();
namespace rigmap {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Sum of the products of a window's padded rows with rows of pixels.
int SumOfProducts(const std::int16_t* window, const std::uint8_t* pixels, std::size_t stride) {
  const hn::CappedTag<std::int16_t, kPaddedSize> d;
  const hn::Rebind<std::uint8_t, decltype(d)> bytes;
  const hn::RepartitionToWide<decltype(d)> wide;
  auto sum = hn::Zero(wide), other = hn::Zero(wide);
  for (int y = 0; y < kWindowSize; ++y, window += kPaddedSize, pixels += stride) {
    for (int x = 0; x < kPaddedSize; x += static_cast<int>(hn::Lanes(d))) {
      const auto b = hn::PromoteTo(d, hn::LoadU(bytes, pixels + x));
      sum = hn::ReorderWidenMulAccumulate(wide, hn::LoadU(d, window + x), b, sum, other);
    }
  }
  return hn::GetLane(hn::SumOfLanes(wide, hn::Add(sum, other)));
}

}  // namespace HWY_NAMESPACE
}  // namespace rigmap
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rigmap {

HWY_EXPORT(SumOfProducts);

namespace {

constexpr int kArea = kWindowSize * kWindowSize;

bool Inside(const cv::Mat& image, const cv::Point& at) {
  return at.x >= kWindowRadius && at.y >= kWindowRadius && at.x < image.cols - kWindowRadius &&
         at.y < image.rows - kWindowRadius;
}

template <class Value>
double WindowSum(const cv::Mat& integral, const cv::Point& at) {
  const Value* top = integral.ptr<Value>(at.y - kWindowRadius) + at.x - kWindowRadius;
  const Value* bottom = integral.ptr<Value>(at.y + kWindowRadius + 1) + at.x - kWindowRadius;
  return static_cast<double>(bottom[kWindowSize] - bottom[0] - top[kWindowSize] + top[0]);
}

// The same image, with kPaddedSize readable bytes from every pixel on.
cv::Mat WithRoomBehind(const cv::Mat& image) {
  cv::Mat roomy(image.rows + 1, image.cols + kPaddedSize, CV_8UC1, cv::Scalar(0));
  cv::Mat inside = roomy(cv::Rect(0, 0, image.cols, image.rows));
  image.copyTo(inside);
  return inside;
}

}  // namespace

// Rows of the window filled up with zeros, so that whole vectors are multiplied.
struct EpipolarSearch::SourceWindow {
  std::array<std::int16_t, kWindowSize * kPaddedSize> rows{};
  double mean = 0.0;
  float inverse_deviation = 0.0F;
};

EpipolarSearch::EpipolarSearch(Side source, Side target, const Rigid3& target_from_source,
                               int reduction)
    : source_(std::move(source)),
      target_(std::move(target)),
      target_from_source_(target_from_source),
      reduction_(reduction) {
  source_statistics_ = StatisticsOf(source_.image);
  target_statistics_ = StatisticsOf(target_.image);
  target_.image = WithRoomBehind(target_.image);
}

EpipolarSearch::WindowStatistics EpipolarSearch::StatisticsOf(const cv::Mat& image) {
  cv::Mat sums, squares;
  cv::integral(image, sums, squares, CV_32S, CV_64F);
  WindowStatistics statistics{cv::Mat::zeros(image.size(), CV_32S),
                              cv::Mat::zeros(image.size(), CV_32F)};
  for (cv::Point at(0, kWindowRadius); at.y < image.rows - kWindowRadius; ++at.y) {
    for (at.x = kWindowRadius; at.x < image.cols - kWindowRadius; ++at.x) {
      const double sum = WindowSum<int>(sums, at);
      const double variance = WindowSum<double>(squares, at) - sum * sum / kArea;
      constexpr double kFlat = kArea;  // one grey level of deviation
      statistics.sum.at<int>(at) = static_cast<int>(sum);
      if (variance < kFlat) continue;
      statistics.inverse_deviation.at<float>(at) = static_cast<float>(1.0 / std::sqrt(variance));
    }
  }
  return statistics;
}

EpipolarSearch::SourceWindow EpipolarSearch::WindowAt(const cv::Point& at) const {
  SourceWindow window{.mean = static_cast<double>(source_statistics_.sum.at<int>(at)) / kArea,
                      .inverse_deviation = source_statistics_.inverse_deviation.at<float>(at)};
  for (int y = 0; y < kWindowSize; ++y) {
    const std::uint8_t* row = source_.image.ptr(at.y + y - kWindowRadius) + at.x - kWindowRadius;
    std::copy_n(row, kWindowSize, window.rows.begin() + y * kPaddedSize);
  }
  return window;
}

Eigen::Vector2d EpipolarSearch::Transfer(const Eigen::Vector2d& normalised,
                                         double inverse_depth) const {
  const Eigen::Vector3d ray = target_from_source_.rotation * normalised.homogeneous() +
                              inverse_depth * target_from_source_.translation;
  return Distort(target_.camera, ray.hnormalized());
}

double EpipolarSearch::Correlation(const SourceWindow& window, const cv::Point& target_at) const {
  const float inverse_deviation =
      target_statistics_.inverse_deviation.at<float>(target_at.y, target_at.x);
  if (window.inverse_deviation == 0.0F || inverse_deviation == 0.0F) return -1.0;
  const std::uint8_t* corner =
      target_.image.ptr(target_at.y - kWindowRadius) + target_at.x - kWindowRadius;
  const int product =
      HWY_DYNAMIC_DISPATCH(SumOfProducts)(window.rows.data(), corner, target_.image.step);
  const double covariance =
      product - window.mean * target_statistics_.sum.at<int>(target_at.y, target_at.x);
  return covariance * window.inverse_deviation * inverse_deviation;
}

std::optional<EpipolarMatch> EpipolarSearch::Find(const Eigen::Vector2d& pixel,
                                                  const Range& range) const {
  const auto reduced = [&](const Eigen::Vector2d& full) {
    return Eigen::Vector2d((full.array() + 0.5) / reduction_ - 0.5);
  };
  const auto rounded = [&](const Eigen::Vector2d& x) {
    return cv::Point(cvRound(x.x()), cvRound(x.y()));
  };
  const cv::Point source_at = rounded(reduced(pixel));
  const auto normalised = Undistort(source_.camera, pixel);
  if (!normalised || !Inside(source_.image, source_at)) return std::nullopt;
  const Eigen::Vector2d far = reduced(Transfer(*normalised, 0.0));
  const Eigen::Vector2d near = reduced(Transfer(*normalised, range.max_inverse_depth));
  if (!far.allFinite() || !near.allFinite()) return std::nullopt;
  const int steps = std::max(1, static_cast<int>(std::ceil((near - far).norm())));
  if (steps > 4 * target_.image.cols) return std::nullopt;  // the curve runs away
  const Eigen::Vector2d along = (near - far).normalized();
  const Eigen::Vector2d across(-along.y(), along.x());
  const int band = static_cast<int>(std::ceil(range.band_px / reduction_));

  const SourceWindow window = WindowAt(source_at);
  std::vector<float> best_at_step(steps + 1, -1.0F);
  EpipolarMatch best;
  int best_step = -1;
  for (int step = 0; step <= steps; ++step) {
    const double inverse_depth = range.max_inverse_depth * step / steps;
    const Eigen::Vector2d on_curve = reduced(Transfer(*normalised, inverse_depth));
    for (int offset = -band; offset <= band; ++offset) {
      const cv::Point at = rounded(on_curve + offset * across);
      if (!Inside(target_.image, at)) continue;
      const double correlation = Correlation(window, at);
      best_at_step[step] = std::max(best_at_step[step], static_cast<float>(correlation));
      if (best_step >= 0 && correlation <= best.correlation) continue;
      best_step = step;
      best.correlation = correlation;
      best.inverse_depth = inverse_depth;
      // The rounding of both windows belongs to the place found.
      const Eigen::Vector2d position =
          Eigen::Vector2d(at.x, at.y) + reduced(pixel) - Eigen::Vector2d(source_at.x, source_at.y);
      best.pixel = (position.array() + 0.5) * reduction_ - 0.5;
    }
  }
  if (best_step < 0) return std::nullopt;
  constexpr int kSamePeak = 2;  // steps
  for (int step = 0; step <= steps; ++step) {
    if (std::abs(step - best_step) <= kSamePeak) continue;
    best.runner_up = std::max(best.runner_up, static_cast<double>(best_at_step[step]));
  }
  return best;
}

}  // namespace rigmap
#endif  // HWY_ONCE
