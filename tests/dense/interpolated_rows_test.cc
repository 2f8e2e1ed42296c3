#include "dense/internal/interpolated_rows.h"

#include <gtest/gtest.h>

namespace rigmap {
namespace {

// Row 0 grows by 10 a pixel, row 1 is x^2.
cv::Mat View() {
  cv::Mat view(2, 16, CV_8UC1);
  for (int x = 0; x < view.cols; ++x) {
    view.at<uchar>(0, x) = static_cast<uchar>(10 * x);
    view.at<uchar>(1, x) = static_cast<uchar>(x * x);
  }
  return view;
}

TEST(InterpolatedRows, AreExactOnWhatTheirPolynomialsAre) {
  const InterpolatedRows rows(View());
  EXPECT_FLOAT_EQ(rows.At(0, 5.3F).Linear(), 53.0F);
  EXPECT_FLOAT_EQ(rows.At(0, 5.3F).Gradient(), 10.0F);
  EXPECT_FLOAT_EQ(rows.At(0, 5.3F).Cubic(), 53.0F);
  EXPECT_FLOAT_EQ(rows.At(1, 5.5F).Linear(), 30.5F);
  EXPECT_FLOAT_EQ(rows.At(1, 5.5F).Gradient(), 11.0F);
  EXPECT_FLOAT_EQ(rows.At(1, 5.5F).Cubic(), 30.25F);
}

TEST(InterpolatedRows, ArePixelsAtPixels) {
  const InterpolatedRows rows(View());
  for (int x = 0; x < 16; ++x) {
    EXPECT_FLOAT_EQ(rows.At(1, static_cast<float>(x)).Linear(), static_cast<float>(x * x));
    EXPECT_FLOAT_EQ(rows.At(1, static_cast<float>(x)).Cubic(), static_cast<float>(x * x));
  }
}

TEST(InterpolatedRows, GoOnBeyondTheirEnds) {
  const InterpolatedRows rows(View());
  EXPECT_FLOAT_EQ(rows.At(1, -7.5F).Linear(), 0.0F);
  EXPECT_FLOAT_EQ(rows.At(1, -7.5F).Cubic(), 0.0F);
  EXPECT_FLOAT_EQ(rows.At(1, 99.0F).Linear(), 225.0F);
  EXPECT_FLOAT_EQ(rows.At(1, 99.0F).Cubic(), 225.0F);
}

}  // namespace
}  // namespace rigmap
