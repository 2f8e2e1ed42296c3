#include "dense/internal/silhouettes.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

constexpr int kViewRows = 100, kViewColumns = 200;
constexpr int kNear = 20, kFar = 8;  // px of disparity
const cv::Rect kBoard(90, 20, 50, 60);

class WidenedEdgesOfABoard : public testing::Test {
 protected:
  void SetUp() override {
    const cv::Mat background = Texture(), board = Texture();
    left_ = background.colRange(kFar, kFar + kViewColumns).clone();
    board(kBoard).copyTo(left_(kBoard));
    right_ = background.colRange(2 * kFar, 2 * kFar + kViewColumns).clone();
    board(kBoard).copyTo(right_(kBoard - cv::Point(kNear, 0)));
    for (cv::Mat* view : {&left_, &right_}) AddNoise(*view);
    disparity_ = cv::Mat(kViewRows, kViewColumns, CV_32F, cv::Scalar(kFar));
    disparity_(kBoard) = kNear;
  }
  cv::Mat Texture() {
    cv::Mat texture(kViewRows, kViewColumns + 2 * kNear, CV_8U);
    for (uchar& value : cv::Mat_<uchar>(texture)) {
      value = static_cast<uchar>(random_.Uniform(0.0, 256.0));
    }
    cv::GaussianBlur(texture, texture, {5, 5}, 1.2);
    return texture;
  }
  void AddNoise(cv::Mat& view) {
    for (int row = 0; row < view.rows; ++row) {
      for (int column = 0; column < view.cols; ++column) {
        auto& value = view.at<uchar>(row, column);
        value = cv::saturate_cast<uchar>(value + random_.Normal(1.0));
      }
    }
  }
  double ShareOf(const cv::Mat& marks, const cv::Rect& area) const {
    return cv::countNonZero(marks(area)) / static_cast<double>(area.area());
  }

  SeededRandom random_;
  cv::Mat left_, right_, disparity_;
};

TEST_F(WidenedEdgesOfABoard, AreNotFoundWhereTheBoardIsAsWideAsItIs) {
  const cv::Mat edges = WidenedEdges(left_, right_, disparity_, {});
  EXPECT_LT(ShareOf(edges, kBoard), 0.1);
  EXPECT_EQ(cv::countNonZero(edges) - cv::countNonZero(edges(kBoard)), 0);
}

TEST_F(WidenedEdgesOfABoard, AreFoundOnEitherSide) {
  const cv::Rect before(kBoard.x - 4, kBoard.y, 4, kBoard.height);
  const cv::Rect behind(kBoard.br().x, kBoard.y, 4, kBoard.height);
  for (const cv::Rect& widened : {before, behind}) {
    cv::Mat wider = disparity_.clone();
    wider(widened) = kNear;
    const cv::Mat edges = WidenedEdges(left_, right_, wider, {});
    EXPECT_GT(ShareOf(edges, widened), 0.8) << widened.x;
    const cv::Rect middle(kBoard.x + 10, kBoard.y + 10, kBoard.width - 20, kBoard.height - 20);
    EXPECT_EQ(ShareOf(edges, middle), 0.0);
  }
}

TEST_F(WidenedEdgesOfABoard, AreNoneWhereNothingStandsBeforeAnything) {
  disparity_.setTo(kFar);
  EXPECT_EQ(cv::countNonZero(WidenedEdges(left_, right_, disparity_, {})), 0);
  disparity_.setTo(0.0F);
  EXPECT_EQ(cv::countNonZero(WidenedEdges(left_, right_, disparity_, {})), 0);
}

}  // namespace
}  // namespace rigmap
