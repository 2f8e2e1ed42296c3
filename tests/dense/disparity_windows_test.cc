#include "dense/internal/disparity_windows.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "dense/internal/winner.h"
#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

constexpr int kStepsPerPx = WinnerRow::kSteps;

cv::Mat NothingFound(cv::Size size) { return {size, CV_16S, cv::Scalar(WinnerRow::kNoDisparity)}; }

bool Holds(const DisparityWindow& window, int disparity) {
  return window.first < disparity && disparity + 1 < window.End();
}

TEST(WholeRange, HoldsTheRange) {
  for (const int range : {0, 31, 32, 100}) {
    const TileWindows windows = WholeRange({50, 20}, range);
    ASSERT_EQ(windows.columns, 4);
    ASSERT_EQ(windows.rows, 2);
    for (const DisparityWindow& window : windows.windows) {
      EXPECT_EQ(window.first, 0);
      EXPECT_GT(window.count, range);
      EXPECT_EQ(window.count % DisparityWindow::kGrain, 0);
    }
  }
}

TEST(WindowsAround, HoldWhatWasFoundInAndAroundEachTile) {
  SeededRandom random;
  for (const cv::Size size : {cv::Size(64, 48), cv::Size(101, 77)}) {
    cv::Mat half = NothingFound(size / 2);
    for (int i = 0; i < 60; ++i) {
      half.at<short>(static_cast<int>(random.Uniform(0.0, half.rows)),
                     static_cast<int>(random.Uniform(0.0, half.cols))) =
          static_cast<short>(random.Uniform(1.0, 60.0) * kStepsPerPx);
    }
    const TileWindows windows = WindowsAround(half, size).value();
    for (int row = 0; row < size.height; ++row) {
      for (int column = 0; column < size.width; ++column) {
        const int steps =
            half.at<short>(std::min(row / 2, half.rows - 1), std::min(column / 2, half.cols - 1));
        if (steps < 0) continue;
        for (const int dx : {-16, 0, 16}) {
          const int near = std::clamp(column + dx, 0, size.width - 1);
          EXPECT_TRUE(Holds(windows.At(near / 16, row / 16), 2 * steps / kStepsPerPx))
              << column << ", " << row;
        }
      }
    }
  }
}

TEST(WindowsAround, AreNarrowOnASurface) {
  const cv::Size size(640, 480);
  cv::Mat half = NothingFound(size / 2);
  for (int row = 0; row < half.rows; ++row) {
    half.row(row) = static_cast<double>(kStepsPerPx * (5 + 0.2 * row));
  }
  const TileWindows windows = WindowsAround(half, size).value();
  for (const DisparityWindow& window : windows.windows) {
    EXPECT_EQ(window.count, DisparityWindow::kGrain);
  }
}

TEST(WindowsAround, TakeThoseOfTheNearestTilesWhereNothingWasFound) {
  cv::Mat half = NothingFound({160, 160});
  half(cv::Rect(0, 0, 80, 80)) = 30 * kStepsPerPx;
  half(cv::Rect(140, 140, 20, 20)) = 100 * kStepsPerPx;
  const TileWindows windows = WindowsAround(half, {320, 320}).value();
  EXPECT_TRUE(Holds(windows.At(12, 2), 60));
  EXPECT_FALSE(Holds(windows.At(12, 2), 200));
  EXPECT_TRUE(Holds(windows.At(16, 16), 200));
  EXPECT_FALSE(Holds(windows.At(19, 19), 60));
}

TEST(WindowsAround, AreNotKnownWhereNothingWasFoundAtAll) {
  EXPECT_FALSE(WindowsAround(NothingFound({50, 40}), {100, 80}));
}

}  // namespace
}  // namespace rigmap
