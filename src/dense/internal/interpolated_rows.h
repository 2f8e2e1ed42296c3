// A view of a rectified pair, looked at between the pixels of its rows.
#pragma once

#include <algorithm>
#include <opencv2/core.hpp>

namespace rigmap {

// The values around a place in a row.
struct RowSamples {
  const float* at;        // at[-1] to at[2]; the place lies between at[0] and at[1]
  float fraction = 0.0F;  // of the way from the one to the other

  float Linear() const { return at[0] + fraction * (at[1] - at[0]); }
  // Along the row, between the central differences at both pixels.
  float Gradient() const {
    const float left = at[1] - at[-1], right = at[2] - at[0];
    return 0.5F * (left + fraction * (right - left));
  }
  // By the cubic that has these differences for slopes at both pixels (Catmull and Rom 1974).
  float Cubic() const {
    const float second = 2.0F * at[-1] - 5.0F * at[0] + 4.0F * at[1] - at[2];
    const float third = 3.0F * (at[0] - at[1]) + at[2] - at[-1];
    return at[0] + 0.5F * fraction * (at[1] - at[-1] + fraction * (second + fraction * third));
  }
};

// Beyond its ends a row goes on as its last pixel. Takes four bytes per pixel.
class InterpolatedRows {
 public:
  explicit InterpolatedRows(const cv::Mat& view);  // CV_8UC1
  RowSamples At(int row, float column) const {
    const float inside = std::clamp(column, 0.0F, last_column_);
    const int whole = static_cast<int>(inside);
    return {padded_.ptr<float>(row) + kBefore + whole, inside - static_cast<float>(whole)};
  }

 private:
  static constexpr int kBefore = 1, kBehind = 2;
  cv::Mat padded_;
  float last_column_;
};

}  // namespace rigmap
