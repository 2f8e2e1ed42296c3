#include "dense/internal/view_rows.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "dense/view_rows.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

// Loops that the compiler turns into vectors by itself.
HWY_BEFORE_NAMESPACE();
namespace rigmap {
namespace HWY_NAMESPACE {

using In = const std::uint8_t* HWY_RESTRICT;
using Out = std::uint8_t* HWY_RESTRICT;

// Calls `at` with each column and those to its left and right.
template <class Function>
HWY_INLINE void ForEachColumn(int width, const Function& at) {
  at(0, 0, std::min(1, width - 1));
  for (int column = 1; column < width - 1; ++column) at(column, column - 1, column + 1);
  at(width - 1, std::max(width - 2, 0), width - 1);
}

void FindGradient(In above, In here, In below, int width, Out gradient) {
  ForEachColumn(width, [&](int column, int left, int right) HWY_ATTR {
    const int slope =
        above[right] - above[left] + 2 * (here[right] - here[left]) + below[right] - below[left];
    gradient[column] = static_cast<std::uint8_t>(
        std::clamp(slope, -kGradientLimit, kGradientLimit) + kGradientLimit);
  });
}

void FindExtremes(In value, int width, Out least, Out most) {
  ForEachColumn(width, [&](int column, int left, int right) HWY_ATTR {
    const int here = value[column];
    const int to_left = (here + value[left]) / 2, to_right = (here + value[right]) / 2;
    least[column] = static_cast<std::uint8_t>(std::min(here, std::min(to_left, to_right)));
    most[column] = static_cast<std::uint8_t>(std::max(here, std::max(to_left, to_right)));
  });
}

HWY_NOINLINE void MeasureRowOf(const cv::Mat& view, int row, const ViewRow& measured) {
  const auto* here = view.ptr<std::uint8_t>(row);
  FindGradient(view.ptr<std::uint8_t>(std::max(row - 1, 0)), here,
               view.ptr<std::uint8_t>(std::min(row + 1, view.rows - 1)), view.cols,
               measured[0].value);
  std::copy_n(here, view.cols, measured[1].value);
  for (const MeasuredRow& by : measured) FindExtremes(by.value, view.cols, by.least, by.most);
}

}  // namespace HWY_NAMESPACE
}  // namespace rigmap
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rigmap {

HWY_EXPORT(MeasureRowOf);

void MeasureRow(const cv::Mat& view, int row, const ViewRow& measured) {
  HWY_DYNAMIC_DISPATCH(MeasureRowOf)(view, row, measured);
}

void MeasureReversed(const cv::Mat& view, int row, int reversed_width, const ViewRow& measured) {
  MeasureRow(view, row, measured);
  for (const MeasuredRow& by : measured) {
    for (std::uint8_t* values : {by.value, by.least, by.most}) {
      std::reverse(values, values + view.cols);
      std::fill(values + view.cols, values + reversed_width, values[view.cols - 1]);
    }
  }
}

}  // namespace rigmap
#endif
