#include "report/pictures.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "core/file.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_file.h"

namespace rigmap {
namespace {

// Of 16, as machine vision cameras write them.
TEST(PictureUrl, ShowsImagesOfTwelveBits) {
  const TemporaryFolder folder;
  cv::Mat eight(48, 64, CV_8UC1), twelve;
  for (int column = 0; column < eight.cols; ++column) {
    eight.col(column) = 255.0 * column / (eight.cols - 1);
  }
  eight.convertTo(twelve, CV_16U, 16.0);
  const auto url = [&](const cv::Mat& image) {
    cv::imwrite((folder.Path() / "image.png").string(), image);
    return PictureUrl(folder.Path() / "image.png", 64, 90);
  };
  EXPECT_THAT(url(eight), testing::StartsWith("data:image/jpeg;base64,"));
  EXPECT_EQ(url(twelve), url(eight));
}

TEST(PictureUrl, OfAnImageThatIsDamagedWithinThereIsNone) {
  const TemporaryFolder folder;
  const auto path = folder.Path() / "image.jpg";
  cv::Mat noise(480, 640, CV_8UC1);
  cv::randu(noise, 0, 255);
  cv::imwrite(path.string(), noise);
  std::string bytes = ReadBytes(path);
  std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() / 2), 200, '\x55');
  WriteTestFile(path, bytes);
  testing::internal::CaptureStderr();
  EXPECT_EQ(PictureUrl(path, 64, 90), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(PictureUrl, OfAnImageThatWasCutThereIsNone) {
  const TemporaryFolder folder;
  const auto path = folder.Path() / "image.jpg";
  EXPECT_EQ(PictureUrl(path, 64, 90), "");
  cv::Mat noise(480, 640, CV_8UC1);
  cv::randu(noise, 0, 255);
  cv::imwrite(path.string(), noise);
  EXPECT_NE(PictureUrl(path, 64, 90), "");
  std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
  testing::internal::CaptureStderr();
  EXPECT_EQ(PictureUrl(path, 64, 90), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace rigmap
