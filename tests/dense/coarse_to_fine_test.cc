#include "dense/internal/coarse_to_fine.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <opencv2/imgproc.hpp>

#include "dense/internal/winner.h"
#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

using DisparityOf = std::function<double(int column, int row)>;  // of a pixel of the left view

struct RenderedPair {
  cv::Mat left, right;
};

// Grey values with detail of 1 to 8 px, wider than the views by `margin` px to either side.
cv::Mat DetailedTexture(SeededRandom& random, cv::Size size) {
  cv::Mat sum(size, CV_32F, cv::Scalar(0.0)), noise(size, CV_32F), smooth;
  for (const double sigma : {1.0, 2.0, 4.0, 8.0}) {
    for (float& value : cv::Mat_<float>(noise))
      value = static_cast<float>(random.Uniform(-1.0, 1.0));
    cv::GaussianBlur(noise, smooth, {}, sigma);
    sum += 60.0 * sigma * smooth;
  }
  return 120.0 + sum;
}

float Between(const cv::Mat& texture, double column, int row) {
  const int i = static_cast<int>(std::floor(column));
  const float share = static_cast<float>(column - i);
  return (1.0F - share) * texture.at<float>(row, i) + share * texture.at<float>(row, i + 1);
}

class CoarseToFine : public testing::Test {
 protected:
  static constexpr int kBeside = 400;  // columns of texture beside the views

  // A background, and a pole before it where the left view's columns are in [from, end).
  RenderedPair Render(cv::Size size, const DisparityOf& background, int from, int end,
                      int pole_disparity) {
    const cv::Mat behind = DetailedTexture(random_, {size.width + 2 * kBeside, size.height});
    const cv::Mat pole = DetailedTexture(random_, behind.size()) + 60.0;
    cv::Mat left(size, CV_32F), right(size, CV_32F);
    for (int row = 0; row < size.height; ++row) {
      for (int column = 0; column < size.width; ++column) {
        const auto in_pole = [&](int x) { return x >= from && x < end; };
        // The background's texture is fixed to the right view.
        left.at<float>(row, column) =
            in_pole(column) ? pole.at<float>(row, column)
                            : Between(behind, kBeside + column - background(column, row), row);
        right.at<float>(row, column) = in_pole(column + pole_disparity)
                                           ? pole.at<float>(row, column + pole_disparity)
                                           : behind.at<float>(row, kBeside + column);
      }
    }
    for (cv::Mat* view : {&left, &right}) {
      for (float& value : cv::Mat_<float>(*view)) value += static_cast<float>(random_.Normal(2.0));
      view->convertTo(*view, CV_8U);
    }
    return {left, right};
  }

  SeededRandom random_;
  DenseOptions options_;
};

TEST_F(CoarseToFine, FindsASlantedPlaneBelowThePixel) {
  // As sand before a rover: from far to near.
  const auto plane = [](int column, int row) { return 8.0 + 0.11 * row + 0.013 * column; };
  const cv::Size size(640, 480);
  const RenderedPair pair = Render(size, plane, 0, 0, 0);
  const cv::Mat found = MatchCoarseToFine(pair.left, pair.right, 160.0, options_);
  double sum = 0.0;
  int known = 0, wrong = 0;
  for (int row = 0; row < size.height; ++row) {
    for (int column = 80; column < size.width; ++column) {
      const int steps = found.at<short>(row, column);
      if (steps < 0) continue;
      const double error = static_cast<double>(steps) / WinnerRow::kSteps - plane(column, row);
      ++known;
      wrong += std::abs(error) > 1.0;
      sum += error * error;
    }
  }
  EXPECT_GT(known, 0.97 * (size.width - 80) * size.height);
  EXPECT_LT(wrong, known / 1000);
  EXPECT_LT(std::sqrt(sum / known), 0.2) << "px";
}

// One in which the range is searched at a quarter of the resolution at most.
TEST_F(CoarseToFine, FindsAPoleBeforeAFarBackground) {
  const cv::Size size(960, 640);
  constexpr int kFrom = 500, kWidth = 8, kDisparity = 70;
  const RenderedPair pair = Render(
      size, [](int, int row) { return 6.0 + 0.02 * row; }, kFrom, kFrom + kWidth, kDisparity);
  const cv::Mat found = MatchCoarseToFine(pair.left, pair.right, 250.0, options_);
  const cv::Mat on_pole = found.colRange(kFrom, kFrom + kWidth);
  const int near = cv::countNonZero(cv::abs(on_pole - kDisparity * WinnerRow::kSteps) < 24);
  EXPECT_GT(near, 0.7 * kWidth * size.height);
}

TEST_F(CoarseToFine, FindsNothingWhereThereIsNothing) {
  const cv::Mat grey(300, 400, CV_8U, cv::Scalar(90));
  EXPECT_EQ(cv::countNonZero(MatchCoarseToFine(grey, grey, 500.0, options_) > 0), 0);
}

TEST_F(CoarseToFine, SearchesWhatLiesInsideNearTheLeftEdge) {
  const auto level = [](int, int) { return 20.0; };
  const cv::Size size(300, 200);
  const RenderedPair pair = Render(size, level, 0, 0, 0);
  const cv::Mat found = MatchCoarseToFine(pair.left, pair.right, 60.0, options_);
  // Block and median need a few columns.
  const cv::Mat inside = found.colRange(25, 60);
  const int right_ones = cv::countNonZero(cv::abs(inside - 20 * WinnerRow::kSteps) < 16);
  EXPECT_GT(right_ones, 0.95 * static_cast<double>(inside.total()));
}

TEST_F(CoarseToFine, TakesAnySize) {
  for (const cv::Size size :
       {cv::Size(1, 1), cv::Size(5, 200), cv::Size(200, 5), cv::Size(65, 67)}) {
    const RenderedPair pair = Render(
        size, [](int, int) { return 3.0; }, 0, 0, 0);
    EXPECT_EQ(MatchCoarseToFine(pair.left, pair.right, 20000.0, options_).size(), size);
  }
}

TEST_F(CoarseToFine, StatesMemoryThatGrowsWithTheImageMoreThanWithTheRange) {
  const auto megabytes = [&](cv::Size size, double range_px) {
    return 1e-6 * static_cast<double>(CoarseToFineBytes(size, range_px, options_));
  };
  EXPECT_LT(megabytes({1024, 768}, 250.0), 200.0);
  EXPECT_LT(megabytes({2448, 2048}, 1500.0), 900.0);
  EXPECT_LT(megabytes({4000, 3000}, 2500.0), 2000.0);
  EXPECT_GT(megabytes({4000, 3000}, 2500.0), megabytes({2000, 1500}, 2500.0));
}

}  // namespace
}  // namespace rigmap
