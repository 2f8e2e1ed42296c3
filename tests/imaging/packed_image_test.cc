#include "imaging/internal/packed_image.h"

#include <gtest/gtest.h>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

cv::Mat RandomImage(SeededRandom& random, cv::Size size, int type) {
  cv::Mat image(size, type);
  const double values = image.depth() == CV_8U ? 256.0 : 65536.0;
  for (int row = 0; row < image.rows; ++row) {
    for (int i = 0; i < image.cols * image.channels(); ++i) {
      const double value = random.Uniform(0.0, values);
      if (image.depth() == CV_8U) {
        image.ptr<std::uint8_t>(row)[i] = static_cast<std::uint8_t>(value);
      } else {
        image.ptr<std::uint16_t>(row)[i] = static_cast<std::uint16_t>(value);
      }
    }
  }
  return image;
}

TEST(PackedImage, ComesBackAsItWas) {
  SeededRandom random;
  for (const int type : {CV_8UC1, CV_8UC3, CV_16UC1, CV_16UC3}) {
    for (const cv::Size size : {cv::Size(1, 1), cv::Size(37, 19), cv::Size(64, 1)}) {
      const cv::Mat image = RandomImage(random, size, type);
      const cv::Mat back = Unpack(Pack(image), size, type);
      ASSERT_EQ(back.type(), type);
      EXPECT_EQ(cv::norm(back, image, cv::NORM_INF), 0.0) << type << " " << size;
    }
  }
}

TEST(PackedImage, TakesAPartOfAnImage) {
  SeededRandom random;
  const cv::Mat image = RandomImage(random, {40, 30}, CV_16UC1);
  const cv::Mat part = image(cv::Rect(5, 6, 20, 10));
  EXPECT_EQ(cv::norm(Unpack(Pack(part), part.size(), part.type()), part, cv::NORM_INF), 0.0);
}

TEST(PackedImage, IsSmallWhereNeighboursAreAlike) {
  cv::Mat ramp(200, 300, CV_16UC1);
  for (int row = 0; row < ramp.rows; ++row) {
    for (int column = 0; column < ramp.cols; ++column) {
      ramp.at<std::uint16_t>(row, column) = static_cast<std::uint16_t>(3 * column + 100 * row);
    }
  }
  EXPECT_LT(Pack(ramp).size(), ramp.total() / 20);
}

TEST(PackedImage, IsEmptyWhereItIsNone) {
  SeededRandom random;
  const cv::Mat image = RandomImage(random, {40, 30}, CV_8UC1);
  std::vector<std::uint8_t> packed = Pack(image);
  EXPECT_TRUE(Unpack(packed, {41, 30}, CV_8UC1).empty());
  EXPECT_TRUE(Unpack(packed, {39, 30}, CV_8UC1).empty());
  EXPECT_TRUE(Unpack({}, {40, 30}, CV_8UC1).empty());
  packed.resize(packed.size() / 2);
  EXPECT_TRUE(Unpack(packed, {40, 30}, CV_8UC1).empty());
}

}  // namespace
}  // namespace rigmap
