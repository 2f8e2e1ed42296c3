#include "dense/internal/semi_global.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "dense/internal/matching_cost.h"
#include "dense/internal/winner.h"
#include "tests/dense/semi_global_reference.h"
#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

constexpr std::size_t kPlenty = std::size_t{1} << 30;  // bytes

// Noise as it is, and smoothed: neighbours alike.
cv::Mat RandomView(SeededRandom& random, cv::Size size) {
  cv::Mat view(size, CV_8U);
  for (uchar& value : cv::Mat_<uchar>(view))
    value = cv::saturate_cast<uchar>(random.Uniform(0, 256));
  cv::Mat smooth;
  cv::GaussianBlur(view, smooth, {}, 1.5);
  smooth.convertTo(smooth, CV_8U, 3.0, -256.0);
  return random.Uniform(0.0, 1.0) < 0.3 ? view : smooth;
}

// Most of it `view`, moved to the left.
cv::Mat Moved(SeededRandom& random, const cv::Mat& view, int shift_px) {
  cv::Mat moved = view.clone();
  for (int row = 0; row < view.rows; ++row) {
    for (int column = 0; column < view.cols; ++column) {
      moved.at<uchar>(row, column) = cv::saturate_cast<uchar>(
          view.at<uchar>(row, std::min(column + shift_px, view.cols - 1)) + random.Normal(2.0));
    }
  }
  return moved;
}

TileWindows RandomWindows(SeededRandom& random, cv::Size size) {
  TileWindows windows(size, DisparityWindow());
  for (DisparityWindow& window : windows.windows) {
    window.first = static_cast<int>(random.Uniform(0.0, 40.0));
    if (random.Uniform(0.0, 1.0) < 0.2) window.first = static_cast<int>(random.Uniform(0, 500.0));
    window.count = DisparityWindow::kGrain * static_cast<int>(random.Uniform(1.0, 4.0));
  }
  return windows;
}

int CountDifferent(const cv::Mat& one, const cv::Mat& other) {
  return cv::countNonZero(one != other);
}

int CountKnown(const cv::Mat& disparity) {
  return cv::countNonZero(disparity != WinnerRow::kNoDisparity);
}

class SemiGlobalReference : public testing::Test {
 protected:
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }

  // With each kind of processor that the kernels were compiled for and this machine can be. Returns
  // how many pixels are known.
  int ExpectEqual(const cv::Mat& left, const cv::Mat& right, const TileWindows& windows) {
    const cv::Mat expected = MatchByReference(left, right, windows, options_);
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
      hwy::SetSupportedTargetsForTest(target);
      const cv::Mat found = MatchSemiGlobal(left, right, windows, options_, kPlenty);
      EXPECT_EQ(CountDifferent(found, expected), 0)
          << hwy::TargetName(target) << ", " << left.size() << ", block " << options_.block_px;
    }
    return CountKnown(expected);
  }

  SeededRandom random_;
  DenseOptions options_;
};

TEST_F(SemiGlobalReference, IsEqualledForAnySizeAndWindows) {
  int known = 0;
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(2, 3), cv::Size(17, 1), cv::Size(1, 17),
                              cv::Size(16, 16), cv::Size(33, 31), cv::Size(70, 37)}) {
    for (const int block_px : {1, 3, 5}) {
      options_.block_px = block_px;
      options_.uniqueness_pct = static_cast<int>(random_.Uniform(0.0, 20.0));
      const cv::Mat left = RandomView(random_, size);
      const cv::Mat right = Moved(random_, left, static_cast<int>(random_.Uniform(1.0, 30.0)));
      known += ExpectEqual(left, right, WholeRange(size, 40));
      known += ExpectEqual(left, right, RandomWindows(random_, size));
    }
  }
  EXPECT_GT(known, 2000);
}

TEST_F(SemiGlobalReference, IsEqualledWithAnyCosts) {
  const cv::Size size(50, 40);
  const cv::Mat left = RandomView(random_, size), right = Moved(random_, left, 7);
  for (const auto& [small, large] : {std::pair(0.01, 0.02), {8.0, 9.0}, {2.0, 1000.0}}) {
    options_.small_step_cost = small;
    options_.large_step_cost = large;
    options_.block_px = 1;
    ExpectEqual(left, right, RandomWindows(random_, size));
  }
  options_.block_px = CostScale::kLargestBlock;
  ExpectEqual(left(cv::Rect(0, 0, 34, 20)), right(cv::Rect(0, 0, 34, 20)),
              WholeRange({34, 20}, 20));
}

TEST_F(SemiGlobalReference, IsEqualledOnARealPair) {
  const char* data = std::getenv("RIGMAP_DATA");
  if (!data) GTEST_SKIP() << "RIGMAP_DATA is not set";
  const std::filesystem::path folder = std::filesystem::path(data) / "dense-pairs/middlebury-cones";
  const cv::Rect part(100, 150, 150, 45);
  const cv::Mat left = cv::imread(folder / "Cones_LEFT.tif", cv::IMREAD_GRAYSCALE)(part);
  const cv::Mat right = cv::imread(folder / "Cones_RIGHT.tif", cv::IMREAD_GRAYSCALE)(part);
  EXPECT_GT(ExpectEqual(left, right, WholeRange(part.size(), 63)), 1000);
  EXPECT_GT(ExpectEqual(left, right, RandomWindows(random_, part.size())), 100);
}

TEST(MatchSemiGlobal, FindsNoMoreThanItsTypeHolds) {
  SeededRandom random;
  const cv::Size size(2400, 20);
  const cv::Mat left = RandomView(random, size);
  for (const int shift : {2030, 2070}) {
    const cv::Mat right = Moved(random, left, shift);
    const TileWindows windows(size, {.first = shift - 16, .count = 32});
    const cv::Mat found = MatchSemiGlobal(left, right, windows, {}, kPlenty);
    EXPECT_EQ(CountKnown(found) > 1000, shift < WinnerRow::kMostDisparity) << shift;
    EXPECT_EQ(cv::countNonZero(found < WinnerRow::kNoDisparity), 0);
  }
}

class SemiGlobal : public testing::Test {
 protected:
  SemiGlobal() {
    left_ = RandomView(random_, size_);
    cv::GaussianBlur(left_, left_, {}, 3.0);  // little texture: paths reach far
    right_ = Moved(random_, left_, 12);
  }
  SeededRandom random_;
  DenseOptions options_;
  const cv::Size size_{200, 1003};
  const TileWindows windows_ = WholeRange(size_, 40);
  cv::Mat left_, right_;
};

TEST_F(SemiGlobal, FindsHardlyElseInStrips) {
  const cv::Mat whole = MatchSemiGlobal(left_, right_, windows_, options_, kPlenty);
  const std::size_t row_bytes = 2 * static_cast<std::size_t>(size_.width) * 64;
  const auto share_that_differs = [&](std::size_t rows_held) {
    const cv::Mat strips =
        MatchSemiGlobal(left_, right_, windows_, options_, rows_held * row_bytes);
    return CountDifferent(strips, whole) / static_cast<double>(size_.area());
  };
  const double smallest = share_that_differs(0);
  EXPECT_GT(smallest, 0.0);
  EXPECT_LT(smallest, 0.01);
  EXPECT_LT(share_that_differs(200), 0.0001);
  EXPECT_EQ(share_that_differs(size_.height), 0.0);
}

TEST_F(SemiGlobal, StatesItsMemory) {
  const std::size_t volume = 2 * static_cast<std::size_t>(size_.area()) * 64;
  const auto bytes = [&](std::size_t limit) { return SemiGlobalBytes(windows_, options_, limit); };
  EXPECT_GT(bytes(kPlenty), volume);
  EXPECT_LT(bytes(kPlenty), 1.2 * static_cast<double>(volume));
  EXPECT_EQ(bytes(kPlenty), bytes(2 * kPlenty));
  EXPECT_EQ(bytes(volume / 2) - bytes(volume / 4), volume / 4);
  EXPECT_EQ(bytes(0), bytes(100)) << "two rows of tiles are needed";
}

}  // namespace
}  // namespace rigmap
