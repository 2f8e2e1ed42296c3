#include "imaging/depth_images.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "core/error.h"
#include "core/file.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

DepthMap SmallMap() {
  DepthMap map;
  map.stamp_ns = 1234567890123456789;
  map.camera = {4, 3, 100.0, 100.0, 1.5, 1.0};
  map.baseline_m = 0.2;
  map.left_from_rectified.rotation =
      Eigen::Quaterniond(Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitY()));
  map.disparity = cv::Mat(3, 4, CV_32F, cv::Scalar(5.0));
  map.disparity_sigma = cv::Mat(3, 4, CV_32F, cv::Scalar(0.1));
  map.disparity.at<float>(0, 1) = 0.0F;
  map.disparity_sigma.at<float>(1, 2) = kUnsurePx;
  return map;
}

TEST(WriteDepthImages, WritesMetresAndTheirSigmas) {
  const TemporaryFolder folder;
  WriteDepthImages(SmallMap(), folder.Path());
  const cv::Mat depth =
      cv::imread((folder.Path() / "1234567890123456789.tif").string(), cv::IMREAD_UNCHANGED);
  const cv::Mat sigma =
      cv::imread((folder.Path() / "1234567890123456789.sigma.tif").string(), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(depth.type(), CV_32FC1);
  ASSERT_EQ(sigma.type(), CV_32FC1);
  ASSERT_EQ(depth.size(), cv::Size(4, 3));
  EXPECT_FLOAT_EQ(depth.at<float>(2, 3), 4.0F);   // 100 px 0.2 m / 5 px
  EXPECT_FLOAT_EQ(sigma.at<float>(2, 3), 0.08F);  // 4 m 0.1 px / 5 px
  for (const cv::Point unknown : {cv::Point(1, 0), cv::Point(2, 1)}) {
    EXPECT_TRUE(std::isnan(depth.at<float>(unknown)));
    EXPECT_TRUE(std::isnan(sigma.at<float>(unknown)));
  }
}

TEST(DepthImage, MarksWhatIsUnknownAsAsked) {
  const cv::Mat depth = DepthImage(SmallMap(), 0.0F);
  ASSERT_EQ(depth.type(), CV_32FC1);
  EXPECT_FLOAT_EQ(depth.at<float>(2, 3), 4.0F);
  EXPECT_EQ(depth.at<float>(0, 1), 0.0F);
  EXPECT_EQ(depth.at<float>(1, 2), 0.0F);
}

TEST(WriteDepthCamera, SaysHowToReadThem) {
  const TemporaryFolder folder;
  WriteDepthCamera(SmallMap(), folder.Path());
  const std::string text = ReadTextFile(folder.Path() / "camera.json");
  EXPECT_NE(text.find("\"width\": 4"), std::string::npos);
  EXPECT_NE(text.find("\"fx\": 100.0"), std::string::npos);
  EXPECT_NE(text.find("\"cx\": 1.5"), std::string::npos);
  EXPECT_NE(text.find("0.0998334"), std::string::npos);  // sin 0.1
}

TEST(WriteDepthImages, NamesWhatCannotBeWritten) {
  const TemporaryFolder folder;
  const auto file = folder.Write("file", "text");
  EXPECT_THROW(WriteDepthImages(SmallMap(), file), DataError);
}

}  // namespace
}  // namespace rigmap
