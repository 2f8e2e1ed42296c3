#include "correspondence/internal/spline_image.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "correspondence/internal/window_samples.h"

namespace rigmap {
namespace {

// How far a pixel is felt: the pole below to this power is 0.001.
constexpr int kReach_px = 5;
constexpr float kPole = std::numbers::sqrt3_v<float> - 2.0F;

// Turns lines of values into six times less than the coefficients of the spline through them,
// across the lines, as if the first and the last line were repeated.
void FilterAcross(int lines, int length, float* values) {
  const auto line = [&](int i) { return values + static_cast<std::ptrdiff_t>(i) * length; };
  for (int k = 0; k < length; ++k) line(0)[k] *= 1.0F / (1.0F - kPole);
  for (int i = 1; i < lines; ++i) {
    const float* before = line(i - 1);
    float* now = line(i);
    for (int k = 0; k < length; ++k) now[k] += kPole * before[k];
  }
  for (int k = 0; k < length; ++k) line(lines - 1)[k] *= -kPole / (1.0F - kPole);
  for (int i = lines - 2; i >= 0; --i) {
    const float* after = line(i + 1);
    float* now = line(i);
    for (int k = 0; k < length; ++k) now[k] = kPole * (after[k] - now[k]);
  }
}

// Six times those of the four coefficients around a place `share` beyond the second.
Four SplineWeights(float share) {
  const Four t = cv::v_setall_f32(share);
  Four weights(-1.0F, 3.0F, -3.0F, 1.0F);
  weights = weights * t + Four(3.0F, -6.0F, 3.0F, 0.0F);
  weights = weights * t + Four(-3.0F, 0.0F, 3.0F, 0.0F);
  return weights * t + Four(1.0F, 4.0F, 1.0F, 0.0F);
}

}  // namespace

void SplineImage::Cover(const Eigen::AlignedBox2d& box) {
  if (covered_.contains(box)) return;
  constexpr double kMore_px = 2.0;
  const Eigen::AlignedBox2d image(Eigen::Vector2d::Zero(),
                                  Eigen::Vector2d(image_.width - 1, image_.height - 1));
  const Eigen::Vector2d more = Eigen::Vector2d::Constant(kMore_px);
  covered_ = Eigen::AlignedBox2d(box.min() - more, box.max() + more).intersection(image);
  WorkOut();
}

void SplineImage::WorkOut() {
  const Eigen::Array2i last = covered_.max().array().floor().cast<int>() + 2 + kReach_px;
  first_ = covered_.min().array().floor().cast<int>() - 1 - kReach_px;
  columns_ = last.x() - first_.x() + 1;
  rows_ = last.y() - first_.y() + 1;
  std::vector<float> by_rows;
  by_rows.reserve(static_cast<std::size_t>(columns_) * rows_);
  for (int row = first_.y(); row <= last.y(); ++row) {
    const std::uint8_t* pixels =
        image_.data +
        static_cast<std::ptrdiff_t>(std::clamp(row, 0, image_.height - 1)) * image_.stride;
    for (int column = first_.x(); column <= last.x(); ++column) {
      by_rows.push_back(pixels[std::clamp(column, 0, image_.width - 1)]);
    }
  }
  FilterAcross(rows_, columns_, by_rows.data());
  coefficients_.resize(by_rows.size());
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      coefficients_[column * rows_ + row] = by_rows[row * columns_ + column];
    }
  }
  FilterAcross(columns_, rows_, coefficients_.data());
}

float SplineImage::operator()(const Eigen::Vector2d& x) const {
  const int column = static_cast<int>(x.x()), row = static_cast<int>(x.y());
  const Four across = SplineWeights(static_cast<float>(x.x() - column));
  const Four down = SplineWeights(static_cast<float>(x.y() - row));
  const float* at = coefficients_.data() +
                    static_cast<std::ptrdiff_t>(column - 1 - first_.x()) * rows_ + row - 1 -
                    first_.y();
  Four sum = cv::v_broadcast_element<0>(across) * cv::v_load(at);
  sum += cv::v_broadcast_element<1>(across) * cv::v_load(at + rows_);
  sum += cv::v_broadcast_element<2>(across) * cv::v_load(at + 2 * rows_);
  sum += cv::v_broadcast_element<3>(across) * cv::v_load(at + 3 * rows_);
  return cv::v_reduce_sum(down * sum);
}

}  // namespace rigmap
