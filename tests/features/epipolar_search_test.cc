#include "features/internal/epipolar_search.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "tests/support/simulated_shot.h"
#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

cv::Mat Reduced(const cv::Mat& image, int reduction) {
  cv::Mat small;
  cv::resize(image, small, cv::Size(), 1.0 / reduction, 1.0 / reduction, cv::INTER_AREA);
  return small;
}

class EpipolarSearchTest : public testing::Test {
 protected:
  // As simulating takes most of the time.
  static void SetUpTestSuite() { shot_ = new SimulatedShot(LocCamRig(), 7); }
  static void TearDownTestSuite() { delete shot_; }

  EpipolarSearch Search(int reduction) const {
    return {{Reduced(shot_->left(), reduction), rig_.left.camera},
            {Reduced(shot_->right(), reduction), rig_.right.camera},
            rig_.right_from_left,
            reduction};
  }

  StereoRig rig_ = LocCamRig();
  EpipolarSearch::Range range_{1.0 / (5.0 * rig_.Baseline()), 4.0};
  inline static SimulatedShot* shot_ = nullptr;
};

TEST_F(EpipolarSearchTest, TransferIsProjectionOfThePointAtThatDepth) {
  const EpipolarSearch search = Search(2);
  for (const double depth_m : {0.7, 2.0, 9.0}) {
    const Eigen::Vector2d normalised(0.15, -0.2);
    const auto expected =
        Project(rig_.right.camera, rig_.right_from_left * (depth_m * normalised.homogeneous()));
    EXPECT_LT((search.Transfer(normalised, 1.0 / depth_m) - *expected).norm(), 1e-9);
  }
}

TEST_F(EpipolarSearchTest, FindsTheMatchToAboutAPixel) {
  for (const int reduction : {1, 2}) {
    const EpipolarSearch search = Search(reduction);
    int tried = 0, correct = 0;
    for (int y = 60; y < 720; y += 60) {
      for (int x = 260; x < 980; x += 60) {
        const Eigen::Vector2d pixel(x + 0.3, y - 0.4);
        const Eigen::Vector3d hit = *shot_->HitAt(pixel);
        const auto truth = Project(rig_.right.camera, rig_.right_from_left * hit);
        ASSERT_TRUE(truth);
        const auto match = search.Find(pixel, range_);
        ASSERT_TRUE(match);
        ++tried;
        // Ambiguous places are for the caller to refuse.
        if (match->correlation < 0.7 || match->correlation - match->runner_up < 0.05) continue;
        EXPECT_LT((match->pixel - *truth).norm(), 1.5 * reduction) << pixel.transpose();
        EXPECT_NEAR(match->inverse_depth, 1.0 / hit.z(), 0.03);
        ++correct;
      }
    }
    EXPECT_GT(correct, 0.9 * tried) << "reduction " << reduction;
  }
}

TEST_F(EpipolarSearchTest, FindsNothingWhereTheWindowLeavesTheImage) {
  const EpipolarSearch search = Search(1);
  EXPECT_FALSE(search.Find({2.0, 300.0}, range_));
  EXPECT_FALSE(search.Find({500.0, 766.0}, range_));
  // In the left image, but too far left to be in the right one.
  const auto match = search.Find({8.0, 300.0}, range_);
  EXPECT_TRUE(!match || match->correlation < 0.8);
}

TEST_F(EpipolarSearchTest, FlatWindowsCorrelateWithNothing) {
  const cv::Mat flat(768, 1024, CV_8UC1, cv::Scalar(90));
  const EpipolarSearch search({flat, rig_.left.camera}, {shot_->right(), rig_.right.camera},
                              rig_.right_from_left, 1);
  const auto match = search.Find({500.0, 300.0}, range_);
  ASSERT_TRUE(match);
  EXPECT_EQ(match->correlation, -1.0);
}

}  // namespace
}  // namespace rigmap
