#include "imaging/image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "core/error.h"
#include "tests/support/message_of.h"
#include "tests/support/seeded_random.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

using testing::AllOf;
using testing::HasSubstr;

Camera CameraOf(int width, int height) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  return camera;
}

cv::Mat RandomImage(int type, double high) {
  SeededRandom random;
  cv::Mat image(20, 30, type);
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.cols; ++column) {
      const double value = std::floor(random.Uniform(0.0, high));
      if (type == CV_8UC1) image.at<uchar>(row, column) = static_cast<uchar>(value);
      if (type == CV_16UC1) image.at<ushort>(row, column) = static_cast<ushort>(value);
    }
  }
  return image;
}

double LargestDifference(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, cv::NORM_INF);
}

TEST(ReadGrey, GivesBackEightBitPixelsUnchanged) {
  const TemporaryFolder folder;
  const cv::Mat image = RandomImage(CV_8UC1, 256.0);
  for (const char* name : {"a.png", "a.pgm", "a.tif"}) {
    const std::string path = folder.Path() / name;
    cv::imwrite(path, image);
    EXPECT_EQ(LargestDifference(ReadGrey(path, CameraOf(30, 20)), image), 0.0) << name;
  }
}

TEST(ReadColour, GivesGreyForGreyFiles) {
  const TemporaryFolder folder;
  const cv::Mat image = RandomImage(CV_8UC1, 256.0);
  const std::string path = folder.Path() / "a.png";
  cv::imwrite(path, image);
  std::vector<cv::Mat> channels;
  cv::split(ReadColour(path, CameraOf(30, 20)), channels);
  ASSERT_EQ(channels.size(), 3U);
  for (const cv::Mat& channel : channels) EXPECT_EQ(LargestDifference(channel, image), 0.0);
}

TEST(ReadColour, KeepsOpenCvsOrderOfChannels) {
  const TemporaryFolder folder;
  const cv::Mat blue(20, 30, CV_8UC3, cv::Scalar(200, 10, 20));
  const std::string path = folder.Path() / "blue.png";
  cv::imwrite(path, blue);
  EXPECT_EQ(LargestDifference(ReadColour(path, CameraOf(30, 20)), blue), 0.0);
}

TEST(ReadGrey, ScalesSixteenBitByAFixedFactor) {
  const TemporaryFolder folder;
  cv::Mat image = RandomImage(CV_16UC1, 65280.0);
  image.at<ushort>(0, 0) = 5000;  // not 12 bit, whatever the random numbers say
  const std::string path = folder.Path() / "a.png";
  cv::imwrite(path, image);
  cv::Mat expected;
  image.convertTo(expected, CV_8U, 1.0 / 256.0);
  EXPECT_EQ(LargestDifference(ReadGrey(path, CameraOf(30, 20)), expected), 0.0);
}

TEST(ReadGrey, TakesSmallSixteenBitValuesAsTwelveBit) {
  const TemporaryFolder folder;
  const cv::Mat image = RandomImage(CV_16UC1, 4080.0);
  const std::string path = folder.Path() / "a.png";
  cv::imwrite(path, image);
  cv::Mat expected;
  image.convertTo(expected, CV_8U, 1.0 / 16.0);
  EXPECT_EQ(LargestDifference(ReadGrey(path, CameraOf(30, 20)), expected), 0.0);
}

std::string ReadingFails(const std::string& path) {
  return MessageOf<DataError>([&] { ReadGrey(path, CameraOf(30, 20)); });
}

TEST(ReadGrey, NamesFileAndBothSizes) {
  const TemporaryFolder folder;
  const std::string path = folder.Path() / "a.png";
  cv::imwrite(path, RandomImage(CV_8UC1, 256.0));
  EXPECT_THAT(MessageOf<DataError>([&] { ReadGrey(path, CameraOf(31, 20)); }),
              AllOf(HasSubstr(path), HasSubstr("31 x 20"), HasSubstr("30 x 20")));
}

TEST(ReadGrey, NamesFilesThatAreMissingOrDamaged) {
  const TemporaryFolder folder;
  const std::string missing = folder.Path() / "missing.png";
  EXPECT_THAT(ReadingFails(missing), HasSubstr(missing));
  const std::string damaged = folder.Path() / "damaged.png";
  std::ofstream(damaged) << "no image";
  EXPECT_THAT(ReadingFails(damaged), AllOf(HasSubstr(damaged), HasSubstr("cannot be decoded")));
}

}  // namespace
}  // namespace rigmap
