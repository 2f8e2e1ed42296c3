#include "dense/internal/window_moments.h"

#include <algorithm>
#include <vector>

namespace rigmap {
namespace {

enum Sum { kCount, kResidual, kGradient, kGradient2, kProduct, kResidual2, kSums };

// Rows of all sums, one behind the other, each with room for half a window before and behind it.
class SumRows {
 public:
  SumRows(int columns, int radius_px)
      : columns_(columns),
        width_(columns + 2 * radius_px),
        radius_px_(radius_px),
        values_(static_cast<std::size_t>(width_) * kSums, 0.0F) {}

  float* Of(Sum sum) { return values_.data() + sum * width_ + radius_px_; }
  void Clear() { std::ranges::fill(values_, 0.0F); }
  void Add(const SumRows& other) {
    for (std::size_t i = 0; i < values_.size(); ++i) values_[i] += other.values_[i];
  }
  // Of a row of the image.
  void Take(const uchar* known, const float* residual, const float* gradient) {
    auto *count = Of(kCount), *residuals = Of(kResidual), *gradients = Of(kGradient);
    auto *gradient2 = Of(kGradient2), *product = Of(kProduct), *residual2 = Of(kResidual2);
    for (int x = 0; x < columns_; ++x) {
      const float one = known[x] != 0 ? 1.0F : 0.0F;
      const float r = one * residual[x], g = one * gradient[x];
      count[x] = one;
      residuals[x] = r;
      gradients[x] = g;
      gradient2[x] = g * g;
      product[x] = g * r;
      residual2[x] = r * r;
    }
  }
  // Each value becomes the sum of those in the window around it.
  void SumAlong(SumRows& summed) const {
    std::ranges::fill(summed.values_, 0.0F);
    const std::size_t inner = values_.size() - 2 * static_cast<std::size_t>(radius_px_);
    float* to = summed.values_.data() + radius_px_;
    for (int shift = 0; shift <= 2 * radius_px_; ++shift) {
      const float* from = values_.data() + shift;
      for (std::size_t i = 0; i < inner; ++i) to[i] += from[i];
    }
  }

 private:
  int columns_, width_, radius_px_;
  std::vector<float> values_;
};

}  // namespace

MomentMaps MomentsOf(const cv::Mat& is_known, const cv::Mat& residual, const cv::Mat& gradient,
                     int side_px) {
  const int radius_px = side_px / 2, columns = residual.cols, rows = residual.rows;
  // Summed anew for each row: running sums would keep what rounding leaves of bright pixels.
  std::vector<SumRows> window(2 * static_cast<std::size_t>(radius_px) + 1, {columns, radius_px});
  SumRows down(columns, radius_px), sums(columns, radius_px);
  MomentMaps moments;
  for (cv::Mat* map : {&moments.counts, &moments.gradient2, &moments.product, &moments.residual2}) {
    map->create(rows, columns, CV_32F);
  }
  for (int next = 0; next < rows + radius_px; ++next) {
    SumRows& last = window[static_cast<std::size_t>(next) % window.size()];
    if (next < rows) {
      last.Take(is_known.ptr<uchar>(next), residual.ptr<float>(next), gradient.ptr<float>(next));
    } else {
      last.Clear();
    }
    const int row = next - radius_px;
    if (row < 0) continue;
    down.Clear();
    for (const SumRows& of_row : window) down.Add(of_row);
    down.SumAlong(sums);
    auto *count = moments.counts.ptr<float>(row), *gradient2 = moments.gradient2.ptr<float>(row);
    auto *product = moments.product.ptr<float>(row), *residual2 = moments.residual2.ptr<float>(row);
    for (int x = 0; x < columns; ++x) {
      const float known = std::max(sums.Of(kCount)[x], 1.0F), each = 1.0F / known;
      const float r = each * sums.Of(kResidual)[x], g = each * sums.Of(kGradient)[x];
      count[x] = known;
      gradient2[x] = each * sums.Of(kGradient2)[x] - g * g;
      product[x] = each * sums.Of(kProduct)[x] - g * r;
      residual2[x] = each * sums.Of(kResidual2)[x] - r * r;
    }
  }
  return moments;
}

}  // namespace rigmap
