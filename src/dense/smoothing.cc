#include <hwy/base.h>

#include <opencv2/core.hpp>

#include "dense/internal/refinement.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "dense/smoothing.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rigmap {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// For as many columns at once as D has lanes, from `middle` on, which lies in rows `stride` floats
// long: takes each two pixels opposite to each other within `radius`.
template <class D, class Take>
HWY_INLINE void ForOpposite(D d, const float* HWY_RESTRICT middle, std::ptrdiff_t stride,
                            int radius, const Take& take) {
  for (int dy = 0; dy <= radius; ++dy) {
    for (int dx = dy == 0 ? 1 : -radius; dx <= radius; ++dx) {
      const std::ptrdiff_t step = dy * stride + dx;
      take(hn::LoadU(d, middle + step), hn::LoadU(d, middle - step));
    }
  }
}

template <class D, class V>
HWY_INLINE auto IsOneSurface(D d, V here, V one, V other) {
  const auto most_px = hn::Set(d, 1.0F);
  return hn::And(hn::Lt(hn::Abs(hn::Sub(one, here)), most_px),
                 hn::Lt(hn::Abs(hn::Sub(other, here)), most_px));
}

struct Smooth {
  template <class D>
  HWY_INLINE void operator()(D d, const float* HWY_RESTRICT middle, std::ptrdiff_t stride,
                             int radius, float* HWY_RESTRICT smooth) const {
    const auto two_pixels = hn::Set(d, 2.0F);
    const auto here = hn::LoadU(d, middle);
    auto sum = here, count = hn::Set(d, 1.0F);
    ForOpposite(d, middle, stride, radius, [&](auto one, auto other) HWY_ATTR {
      const auto same = IsOneSurface(d, here, one, other);
      sum = hn::Add(sum, hn::IfThenElseZero(same, hn::Add(one, other)));
      count = hn::Add(count, hn::IfThenElseZero(same, two_pixels));
    });
    hn::StoreU(hn::Div(sum, count), d, smooth);
  }
};

struct SquareBend {
  template <class D>
  HWY_INLINE void operator()(D d, const float* HWY_RESTRICT middle, std::ptrdiff_t stride,
                             int radius, float* HWY_RESTRICT square) const {
    const auto half = hn::Set(d, 0.5F), one_pair = hn::Set(d, 1.0F);
    const auto here = hn::LoadU(d, middle);
    auto sum = hn::Zero(d), count = hn::Zero(d);
    ForOpposite(d, middle, stride, radius, [&](auto one, auto other) HWY_ATTR {
      const auto same = IsOneSurface(d, here, one, other);
      const auto bend = hn::MulSub(half, hn::Add(one, other), here);
      sum = hn::Add(sum, hn::IfThenElseZero(same, hn::Mul(bend, bend)));
      count = hn::Add(count, hn::IfThenElseZero(same, one_pair));
    });
    hn::StoreU(hn::Div(sum, hn::Max(count, one_pair)), d, square);
  }
};

template <class Columns>
HWY_INLINE void ForRow(const Columns& columns_at, const float* HWY_RESTRICT middle,
                       std::ptrdiff_t stride, int radius, int columns, float* HWY_RESTRICT found) {
  const hn::ScalableTag<float> d;
  const hn::CappedTag<float, 1> one;
  const int lanes = static_cast<int>(hn::Lanes(d));
  int column = 0;
  for (; column + lanes <= columns; column += lanes) {
    columns_at(d, middle + column, stride, radius, found + column);
  }
  for (; column < columns; ++column) {
    columns_at(one, middle + column, stride, radius, found + column);
  }
}

HWY_NOINLINE void SmoothRow(const float* HWY_RESTRICT middle, std::ptrdiff_t stride, int radius,
                            int columns, float* HWY_RESTRICT smooth) {
  ForRow(Smooth{}, middle, stride, radius, columns, smooth);
}

HWY_NOINLINE void SquareBendRow(const float* HWY_RESTRICT middle, std::ptrdiff_t stride, int radius,
                                int columns, float* HWY_RESTRICT squares) {
  ForRow(SquareBend{}, middle, stride, radius, columns, squares);
}

}  // namespace HWY_NAMESPACE
}  // namespace rigmap
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rigmap {

HWY_EXPORT(SmoothRow);
HWY_EXPORT(SquareBendRow);

namespace {

// Of each known disparity; 0 for the others.
template <class Row>
cv::Mat ByRows(const cv::Mat& disparity, int radius_px, const Row& row_at) {
  constexpr double kUnknown = -1e4;  // no disparity is near it
  cv::Mat known_only = disparity.clone(), padded, found(disparity.size(), CV_32F);
  known_only.setTo(kUnknown, disparity <= 0.0F);
  cv::copyMakeBorder(known_only, padded, radius_px, radius_px, radius_px, radius_px,
                     cv::BORDER_CONSTANT, cv::Scalar(kUnknown));
  const auto stride = static_cast<std::ptrdiff_t>(padded.step1());
  for (int row = 0; row < disparity.rows; ++row) {
    row_at(padded.ptr<float>(row + radius_px) + radius_px, stride, radius_px, disparity.cols,
           found.ptr<float>(row));
  }
  found.setTo(0.0F, disparity <= 0.0F);
  return found;
}

}  // namespace

cv::Mat SmoothDisparity(const cv::Mat& disparity, int radius_px) {
  return ByRows(disparity, radius_px, [](auto... args) {
    HWY_DYNAMIC_DISPATCH(SmoothRow)(args...);
  });
}

cv::Mat SquareBendOf(const cv::Mat& disparity, int radius_px) {
  return ByRows(disparity, radius_px, [](auto... args) {
    HWY_DYNAMIC_DISPATCH(SquareBendRow)(args...);
  });
}

}  // namespace rigmap
#endif
