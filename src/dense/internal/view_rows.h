// Rows of rectified views, as matching costs compare them.
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace rigmap {

// A row of a view by one measure: its values, and the least and most that each has within half a
// pixel.
struct MeasuredRow {
  std::uint8_t *value = nullptr, *least = nullptr, *most = nullptr;
};

// By horizontal gradient, Sobel's, clipped at kGradientLimit and made positive, and by grey value.
using ViewRow = std::array<MeasuredRow, 2>;
inline constexpr int kGradientLimit = 63;

// What the costs of some rows are made from. Right rows are reversed, so that disparities count
// upwards: column x lies at width - 1 - x, and what is beyond the edge repeats it.
struct ViewRows {
  int width = 0;
  std::vector<ViewRow> left, right;
};

// A row of a view (CV_8UC1); the view's edges are repeated.
void MeasureRow(const cv::Mat& view, int row, const ViewRow& measured);

// Reversed, the last value repeated up to `reversed_width` of them.
void MeasureReversed(const cv::Mat& view, int row, int reversed_width, const ViewRow& measured);

}  // namespace rigmap
