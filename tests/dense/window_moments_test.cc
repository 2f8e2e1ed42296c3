#include "dense/internal/window_moments.h"

#include <gtest/gtest.h>

#include <vector>

namespace rigmap {
namespace {

constexpr int kSide_px = 5;

struct Views {
  cv::Mat is_known, residual, gradient;
};

Views MakeViews() {
  Views views{cv::Mat(12, 17, CV_8UC1), cv::Mat(12, 17, CV_32F), cv::Mat(12, 17, CV_32F)};
  cv::RNG random(3);
  random.fill(views.residual, cv::RNG::NORMAL, 5.0, 3.0);
  random.fill(views.gradient, cv::RNG::NORMAL, -2.0, 20.0);
  random.fill(views.is_known, cv::RNG::UNIFORM, 0, 2);
  views.is_known *= 255;
  return views;
}

// By the definition, in double.
void ExpectMoments(const Views& views, const MomentMaps& moments, int row, int column) {
  std::vector<double> r, g;
  for (int y = row - kSide_px / 2; y <= row + kSide_px / 2; ++y) {
    for (int x = column - kSide_px / 2; x <= column + kSide_px / 2; ++x) {
      if (!cv::Rect({}, views.residual.size()).contains({x, y})) continue;
      if (views.is_known.at<uchar>(y, x) == 0) continue;
      r.push_back(views.residual.at<float>(y, x));
      g.push_back(views.gradient.at<float>(y, x));
    }
  }
  ASSERT_FALSE(r.empty());
  const auto covariance = [](const std::vector<double>& a, const std::vector<double>& b) {
    const auto n = static_cast<double>(a.size());
    return cv::Mat(a).dot(cv::Mat(b)) / n - cv::sum(a)[0] * cv::sum(b)[0] / (n * n);
  };
  EXPECT_EQ(moments.counts.at<float>(row, column), static_cast<float>(r.size()));
  EXPECT_NEAR(moments.gradient2.at<float>(row, column), covariance(g, g), 1e-3);
  EXPECT_NEAR(moments.product.at<float>(row, column), covariance(g, r), 1e-3);
  EXPECT_NEAR(moments.residual2.at<float>(row, column), covariance(r, r), 1e-3);
}

TEST(MomentsOf, AreThoseOfWhatIsKnownInEachWindow) {
  const Views views = MakeViews();
  const MomentMaps moments = MomentsOf(views.is_known, views.residual, views.gradient, kSide_px);
  for (int row = 0; row < views.residual.rows; ++row) {
    for (int column = 0; column < views.residual.cols; ++column) {
      ExpectMoments(views, moments, row, column);
    }
  }
}

TEST(MomentsOf, OfNothingKnownAreNothing) {
  Views views = MakeViews();
  views.is_known = 0;
  const MomentMaps moments = MomentsOf(views.is_known, views.residual, views.gradient, kSide_px);
  EXPECT_EQ(cv::countNonZero(moments.counts != 1.0F), 0);
  EXPECT_EQ(cv::countNonZero(moments.gradient2), 0);
  EXPECT_EQ(cv::countNonZero(moments.product), 0);
  EXPECT_EQ(cv::countNonZero(moments.residual2), 0);
}

}  // namespace
}  // namespace rigmap
