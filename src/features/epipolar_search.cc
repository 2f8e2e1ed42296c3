#include "features/internal/epipolar_search.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace rigmap {
namespace {

constexpr int kRadius = 4;  // 9 x 9 pixels of the reduced image
constexpr int kSize = 2 * kRadius + 1;
constexpr int kArea = kSize * kSize;

bool Inside(const cv::Mat& image, const cv::Point& at) {
  return at.x >= kRadius && at.y >= kRadius && at.x < image.cols - kRadius &&
         at.y < image.rows - kRadius;
}

template <class Value>
double WindowSum(const cv::Mat& integral, const cv::Point& at) {
  const Value* top = integral.ptr<Value>(at.y - kRadius) + at.x - kRadius;
  const Value* bottom = integral.ptr<Value>(at.y + kRadius + 1) + at.x - kRadius;
  return static_cast<double>(bottom[kSize] - bottom[0] - top[kSize] + top[0]);
}

}  // namespace

EpipolarSearch::EpipolarSearch(Side source, Side target, const Rigid3& target_from_source,
                               int reduction)
    : source_(std::move(source)),
      target_(std::move(target)),
      target_from_source_(target_from_source),
      reduction_(reduction) {
  cv::integral(source_.image, source_sums_.sum, source_sums_.square, CV_32S, CV_64F);
  cv::integral(target_.image, target_sums_.sum, target_sums_.square, CV_32S, CV_64F);
}

Eigen::Vector2d EpipolarSearch::Transfer(const Eigen::Vector2d& normalised,
                                         double inverse_depth) const {
  const Eigen::Vector3d ray = target_from_source_.rotation * normalised.homogeneous() +
                              inverse_depth * target_from_source_.translation;
  return Distort(target_.camera, ray.hnormalized());
}

double EpipolarSearch::Correlation(const cv::Point& source_at, const cv::Point& target_at) const {
  int product = 0;
  for (int y = -kRadius; y <= kRadius; ++y) {
    const std::uint8_t* a = source_.image.ptr(source_at.y + y) + source_at.x - kRadius;
    const std::uint8_t* b = target_.image.ptr(target_at.y + y) + target_at.x - kRadius;
    for (int x = 0; x < kSize; ++x) product += a[x] * b[x];
  }
  const double sum_a = WindowSum<int>(source_sums_.sum, source_at);
  const double sum_b = WindowSum<int>(target_sums_.sum, target_at);
  const double variance_a =
      WindowSum<double>(source_sums_.square, source_at) - sum_a * sum_a / kArea;
  const double variance_b =
      WindowSum<double>(target_sums_.square, target_at) - sum_b * sum_b / kArea;
  constexpr double kFlat = kArea;  // one grey level of deviation
  if (variance_a < kFlat || variance_b < kFlat) return -1.0;
  return (product - sum_a * sum_b / kArea) / std::sqrt(variance_a * variance_b);
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

  std::vector<float> best_at_step(steps + 1, -1.0F);
  EpipolarMatch best;
  int best_step = -1;
  for (int step = 0; step <= steps; ++step) {
    const double inverse_depth = range.max_inverse_depth * step / steps;
    const Eigen::Vector2d on_curve = reduced(Transfer(*normalised, inverse_depth));
    for (int offset = -band; offset <= band; ++offset) {
      const cv::Point at = rounded(on_curve + offset * across);
      if (!Inside(target_.image, at)) continue;
      const double correlation = Correlation(source_at, at);
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
