#include "imaging/image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <thread>
#include <vector>

#include "core/error.h"
#include "core/file.h"
#include "core/memory_peak.h"
#include "tests/support/message_of.h"
#include "tests/support/seeded_random.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_file.h"

namespace rigmap {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

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

void WriteRandomImage(const std::filesystem::path& path) {
  cv::imwrite(path.string(), RandomImage(CV_8UC1, 256.0));
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

// Also one that is so dark that it might be of 12 bit.
TEST(ReadGrey, ScalesSixteenBitByAFixedFactor) {
  const TemporaryFolder folder;
  cv::Mat image = RandomImage(CV_16UC1, 4000.0);
  const std::string path = folder.Path() / "a.png";
  cv::imwrite(path, image);
  cv::Mat expected;
  image.convertTo(expected, CV_8U, 1.0 / 256.0);
  EXPECT_EQ(LargestDifference(ReadGrey(path, CameraOf(30, 20)), expected), 0.0);
}

TEST(ReadGrey, ScalesTwelveBitValuesWhereItIsTold) {
  const TemporaryFolder folder;
  cv::Mat image = RandomImage(CV_16UC1, 4080.0);
  image.at<ushort>(0, 0) = 5000;  // is white
  const std::string path = folder.Path() / "a.png";
  cv::imwrite(path, image);
  cv::Mat expected;
  image.convertTo(expected, CV_8U, 1.0 / 16.0);
  EXPECT_EQ(LargestDifference(ReadGrey(path, CameraOf(30, 20), 12), expected), 0.0);
}

TEST(SampleBitsNeeded, TellsOfSixteenBitFilesWhetherFewerWouldDo) {
  const TemporaryFolder folder;
  const auto of = [&](const char* name, const cv::Mat& image, int width = 30) {
    const std::string path = folder.Path() / name;
    cv::imwrite(path, image);
    return SampleBitsNeeded(path, CameraOf(width, 20));
  };
  cv::Mat image = RandomImage(CV_16UC1, 4096.0);
  for (const char* name : {"a.png", "a.pgm", "a.tif"}) EXPECT_EQ(of(name, image), 12) << name;
  const cv::Mat see_through(20, 30, CV_16UC4, cv::Scalar(100, 200, 4095, 65535));
  EXPECT_EQ(of("alpha.png", see_through), 12) << "alpha is no brightness";
  EXPECT_EQ(of("other.png", image, 31), std::nullopt) << "not of the camera's size";
  EXPECT_EQ(of("ten.png", RandomImage(CV_16UC1, 1024.0)), 10);
  image.at<ushort>(3, 4) = 4096;
  EXPECT_EQ(of("fourteen.png", image), 14);
  image.at<ushort>(3, 4) = 16384;
  for (const char* name : {"b.png", "b.pgm", "b.tif"}) EXPECT_EQ(of(name, image), 16) << name;
  for (const char* name : {"c.png", "c.pgm", "c.tif", "c.jpg"}) {
    EXPECT_EQ(of(name, RandomImage(CV_8UC1, 256.0)), std::nullopt) << name;
  }
  EXPECT_EQ(SampleBitsNeeded(folder.Write("d.png", "text"), CameraOf(30, 20)), std::nullopt);
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

TEST(ReadGrey, TellsDamagedFilesFromMissingOnesAndOtherSizes) {
  const TemporaryFolder folder;
  const std::string path = folder.Path() / "a.png";
  EXPECT_THROW(ReadSize(path), DataError);
  EXPECT_THAT([&] { ReadSize(path); }, Not(testing::Throws<UnreadableImage>()));
  WriteRandomImage(path);
  EXPECT_EQ(ReadSize(path), cv::Size(30, 20));
  EXPECT_THAT([&] { ReadGrey(path, CameraOf(31, 20)); }, Not(testing::Throws<UnreadableImage>()));
  std::ofstream(path) << "no image";
  EXPECT_THROW(ReadSize(path), UnreadableImage);
}

// OpenCV itself fills the rest of such a file with grey.
TEST(ReadGrey, RefusesFloatingPointNumbers) {
  const TemporaryFolder folder;
  const std::string path = folder.Path() / "float.tif";
  ASSERT_TRUE(cv::imwrite(path, cv::Mat(20, 30, CV_32F, cv::Scalar(0.5))));
  const auto message = MessageOf<DataError>([&] { ReadGrey(path, CameraOf(30, 20), 16); });
  EXPECT_THAT(message, AllOf(HasSubstr("float.tif: expected an image of 8 or 16 bit"),
                             HasSubstr("floating-point numbers of 32")));
}

TEST(ReadGrey, RefusesWhatIsCutOff) {
  const TemporaryFolder folder;
  for (const char* name : {"a.png", "a.jpg"}) {
    const std::filesystem::path path = folder.Path() / name;
    WriteRandomImage(path);
    std::filesystem::resize_file(path, std::filesystem::file_size(path) * 2 / 3);
    EXPECT_THROW(ReadGrey(path, CameraOf(30, 20)), UnreadableImage) << name;
  }
}

// A scene as cameras see it, not noise.
cv::Mat SmoothImage(int type) {
  cv::Mat image(120, 160, type);
  cv::randu(image, 0, 256);
  cv::GaussianBlur(image, image, cv::Size(), 3.0);
  return image;
}

TEST(ReadGrey, DecodesJpegAsOpenCvDoes) {
  const TemporaryFolder folder;
  const std::string path = folder.Path() / "a.jpg";
  const Camera camera = CameraOf(160, 120);
  for (const int type : {CV_8UC1, CV_8UC3}) {
    ASSERT_TRUE(cv::imwrite(path, SmoothImage(type)));
    const cv::Mat grey = cv::imread(path, cv::IMREAD_GRAYSCALE), colour = cv::imread(path);
    EXPECT_EQ(LargestDifference(ReadGrey(path, camera), grey), 0.0);
    EXPECT_EQ(LargestDifference(ReadColour(path, camera), colour), 0.0);
  }
}

// Its end is there, so that only the decoder finds it.
TEST(ReadGrey, RefusesAJpegThatIsDamagedWithin) {
  const TemporaryFolder folder;
  const std::string path = folder.Path() / "a.jpg";
  ASSERT_TRUE(cv::imwrite(path, SmoothImage(CV_8UC1), {cv::IMWRITE_JPEG_QUALITY, 96}));
  const std::string whole = ReadBytes(path);
  std::string damaged = whole;
  const auto middle = static_cast<std::ptrdiff_t>(whole.size() / 2);
  std::fill_n(damaged.begin() + middle, 200, '\x55');
  WriteTestFile(path, damaged);
  EXPECT_TRUE(IsWholeImage(path));
  testing::internal::CaptureStderr();
  EXPECT_THROW(ReadGrey(path, CameraOf(160, 120)), UnreadableImage);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  // Which cameras may write before its end.
  WriteTestFile(path, whole.substr(0, whole.size() - 2) + std::string(3, '\0') + "\xff\xd9");
  const cv::Mat padded = ReadGrey(path, CameraOf(160, 120));
  WriteTestFile(path, whole);
  EXPECT_EQ(LargestDifference(padded, ReadGrey(path, CameraOf(160, 120))), 0.0);
}

// A PNG of one byte of pixels, whose header claims `side` x `side` of them.
std::string ClaimingPng(std::uint32_t side) {
  const std::string chunk_head = "IHDR", flags("\x08\x00\x00\x00\x00", 5);
  std::string size;
  for (int shift = 24; shift >= 0; shift -= 8) size += static_cast<char>((side >> shift) & 0xFF);
  const std::string ihdr = chunk_head + size + size + flags;
  const auto checksum = [](const std::string& bytes) {
    std::uint32_t crc = 0xFFFFFFFFU;
    for (const char byte : bytes) {
      crc ^= static_cast<unsigned char>(byte);
      for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1U) ^ ((crc & 1U) ? 0xEDB88320U : 0U);
    }
    crc = ~crc;
    std::string big_endian;
    for (int shift = 24; shift >= 0; shift -= 8) big_endian += static_cast<char>(crc >> shift);
    return big_endian;
  };
  const std::string idat("IDAT\x78\x9c\x63\x00\x00\x00\x01\x00\x01", 13);
  return std::string("\x89PNG\r\n\x1a\n\0\0\0\x0d", 12) + ihdr + checksum(ihdr) +
         std::string("\0\0\0\x09", 4) + idat + checksum(idat) +
         std::string("\0\0\0\0IEND\xae\x42\x60\x82", 12);
}

// 30,000 x 30,000 is within OpenCV's own limit: it asks for 900 MB before it sees that there are no
// pixels.
TEST(ReadGrey, RefusesAClaimOfAnotherSizeWithoutTheMemory) {
  const TemporaryFolder folder;
  for (const std::uint32_t side : {30'000U, 60'000U, 0x7FFFFFFFU, 0xFFFFFFFFU}) {
    const std::string path = WriteTestFile(folder.Path() / "a.png", ClaimingPng(side));
    MemoryPeak peak;
    const double before_mb = peak.Megabytes();
    EXPECT_THAT(ReadingFails(path),
                AllOf(HasSubstr(path), HasSubstr("expected an image of 30 x 20"),
                      HasSubstr("found " + std::to_string(std::min(side, 0x7FFFFFFFU)))));
    EXPECT_TRUE(IsWholeImage(path));
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    EXPECT_LT(peak.Megabytes(), before_mb + 50.0) << side;
  }
}

class ImageFormatTest : public testing::TestWithParam<const char*> {
 protected:
  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.Path() / (std::string("image.") + GetParam());
};

TEST_P(ImageFormatTest, WholeImageIsWhole) {
  WriteRandomImage(path_);
  EXPECT_TRUE(IsWholeImage(path_));
}

TEST_P(ImageFormatTest, TruncatedImageIsNot) {
  WriteRandomImage(path_);
  const auto size = std::filesystem::file_size(path_);
  std::filesystem::resize_file(path_, size - size / 3);
  EXPECT_FALSE(IsWholeImage(path_));
  std::filesystem::resize_file(path_, 4);
  EXPECT_FALSE(IsWholeImage(path_));
  std::filesystem::resize_file(path_, 0);
  EXPECT_FALSE(IsWholeImage(path_));
}

INSTANTIATE_TEST_SUITE_P(Formats, ImageFormatTest,
                         testing::Values("png", "jpg", "jpeg", "pgm", "tif", "tiff"));

TEST(IsWholeImageTest, LastByteOfPngAndJpegMatters) {
  const TemporaryFolder folder;
  for (const char* name : {"a.png", "a.jpg"}) {
    WriteRandomImage(folder.Path() / name);
    std::filesystem::resize_file(folder.Path() / name,
                                 std::filesystem::file_size(folder.Path() / name) - 1);
    EXPECT_FALSE(IsWholeImage(folder.Path() / name)) << name;
  }
}

TEST(IsWholeImageTest, PaddingBehindTheEndIsAllowed) {
  const TemporaryFolder folder;
  for (const char* name : {"a.png", "a.jpg"}) {
    WriteRandomImage(folder.Path() / name);
    std::ofstream(folder.Path() / name, std::ios::app) << std::string(100, '\0');
    EXPECT_TRUE(IsWholeImage(folder.Path() / name)) << name;
  }
}

TEST(IsWholeImageTest, TextAndMissingFilesAreNoImages) {
  const TemporaryFolder folder;
  EXPECT_FALSE(IsWholeImage(WriteTestFile(folder.Path() / "a.png", "not an image at all\n")));
  EXPECT_FALSE(IsWholeImage(folder.Path() / "none.png"));
  EXPECT_FALSE(IsWholeImage(folder.Path()));
}

}  // namespace
}  // namespace rigmap
