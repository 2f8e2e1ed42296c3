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

// As many columns at once as D has lanes, from `middle` on, which lies in rows `stride` floats
// long.
template <class D>
HWY_INLINE void SmoothColumns(D d, const float* HWY_RESTRICT middle, std::ptrdiff_t stride,
                              int radius, float* HWY_RESTRICT smooth) {
  const auto same_surface = hn::Set(d, 1.0F), two = hn::Set(d, 2.0F);  // px; pixels
  const auto here = hn::LoadU(d, middle);
  auto sum = here, count = hn::Set(d, 1.0F);
  for (int dy = 0; dy <= radius; ++dy) {
    for (int dx = dy == 0 ? 1 : -radius; dx <= radius; ++dx) {
      const std::ptrdiff_t step = dy * stride + dx;
      const auto one = hn::LoadU(d, middle + step), other = hn::LoadU(d, middle - step);
      const auto same = hn::And(hn::Lt(hn::Abs(hn::Sub(one, here)), same_surface),
                                hn::Lt(hn::Abs(hn::Sub(other, here)), same_surface));
      sum = hn::Add(sum, hn::IfThenElseZero(same, hn::Add(one, other)));
      count = hn::Add(count, hn::IfThenElseZero(same, two));
    }
  }
  hn::StoreU(hn::Div(sum, count), d, smooth);
}

HWY_NOINLINE void SmoothRow(const float* HWY_RESTRICT middle, std::ptrdiff_t stride, int radius,
                            int columns, float* HWY_RESTRICT smooth) {
  const hn::ScalableTag<float> d;
  const hn::CappedTag<float, 1> one;
  const int lanes = static_cast<int>(hn::Lanes(d));
  int column = 0;
  for (; column + lanes <= columns; column += lanes) {
    SmoothColumns(d, middle + column, stride, radius, smooth + column);
  }
  for (; column < columns; ++column) {
    SmoothColumns(one, middle + column, stride, radius, smooth + column);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace rigmap
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rigmap {

HWY_EXPORT(SmoothRow);

cv::Mat SmoothDisparity(const cv::Mat& disparity, int radius_px) {
  constexpr double kUnknown = -1e4;  // no disparity is near it
  cv::Mat known_only = disparity.clone(), padded, smooth(disparity.size(), CV_32F);
  known_only.setTo(kUnknown, disparity <= 0.0F);
  cv::copyMakeBorder(known_only, padded, radius_px, radius_px, radius_px, radius_px,
                     cv::BORDER_CONSTANT, cv::Scalar(kUnknown));
  const auto stride = static_cast<std::ptrdiff_t>(padded.step1());
  for (int row = 0; row < disparity.rows; ++row) {
    HWY_DYNAMIC_DISPATCH(SmoothRow)
    (padded.ptr<float>(row + radius_px) + radius_px, stride, radius_px, disparity.cols,
     smooth.ptr<float>(row));
  }
  smooth.setTo(0.0F, disparity <= 0.0F);
  return smooth;
}

}  // namespace rigmap
#endif
