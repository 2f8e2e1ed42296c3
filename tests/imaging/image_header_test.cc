#include "imaging/internal/image_header.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/temporary_folder.h"
#include "tests/support/test_file.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
using std::string_view_literals::operator""sv;

// Any picture whose sides differ and do not fill whole bytes.
cv::Mat Picture(int type) {
  cv::Mat picture(37, 61, type);
  cv::randu(picture, cv::Scalar::all(0), cv::Scalar::all(200));
  return picture;
}

class ImageHeaderTest : public testing::TestWithParam<const char*> {
 protected:
  fs::path Write(int type, const std::vector<int>& parameters = {}) {
    const fs::path path = folder_.Path() / (std::string("image.") + GetParam());
    EXPECT_TRUE(cv::imwrite(path.string(), Picture(type), parameters));
    return path;
  }
  TemporaryFolder folder_;
};

// Whatever the decoder makes of a file, its header has said.
TEST_P(ImageHeaderTest, SaysTheSizeThatDecodingGives) {
  for (const int type : {CV_8UC1, CV_8UC3, CV_16UC1}) {
    const bool is_jpeg = std::string_view(GetParam()).starts_with("jp");
    if (is_jpeg && type == CV_16UC1) continue;
    const bool is_colour = type == CV_8UC3;
    if ((GetParam() == "pgm"sv && is_colour) || (GetParam() == "ppm"sv && !is_colour)) continue;
    const fs::path path = Write(type);
    const cv::Size decoded = cv::imread(path.string(), cv::IMREAD_UNCHANGED).size();
    const auto header = ReadImageHeader(path);
    ASSERT_TRUE(header) << type;
    EXPECT_EQ(cv::Size(static_cast<int>(header->width), static_cast<int>(header->height)), decoded);
    EXPECT_TRUE(header->is_whole) << type;
  }
}

// At each length a file that is cut off says that it is, or nothing; no length is a crash.
TEST_P(ImageHeaderTest, NoPartOfAFileIsWhole) {
  const fs::path path = Write(GetParam() == "ppm"sv ? CV_8UC3 : CV_8UC1);
  const auto size = static_cast<std::int64_t>(fs::file_size(path));
  for (std::int64_t length = size - 1; length >= 0; length -= length > 300 ? 97 : 1) {
    fs::resize_file(path, static_cast<std::uintmax_t>(length));
    const auto header = ReadImageHeader(path);
    EXPECT_FALSE(header && header->is_whole) << length << " of " << size;
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, ImageHeaderTest,
                         testing::Values("png", "jpg", "pgm", "ppm", "tif"));

std::optional<ImageHeader> HeaderOf(const std::string& bytes) {
  const TemporaryFolder folder;
  return ReadImageHeader(WriteTestFile(folder.Path() / "file", bytes));
}

TEST(PnmHeader, CommentsAndTextAreRead) {
  const auto binary = HeaderOf("P5\n# made by hand\n3\t# across\n2\n255\n" + std::string(6, 'x'));
  ASSERT_TRUE(binary);
  EXPECT_EQ(binary->width, 3);
  EXPECT_EQ(binary->height, 2);
  EXPECT_TRUE(binary->is_whole);
  EXPECT_FALSE(HeaderOf("P5 3 2 65535\n" + std::string(11, 'x'))->is_whole);
  EXPECT_TRUE(HeaderOf("P2 2 2 255\n1 2 3 4\n")->is_whole);
  EXPECT_TRUE(HeaderOf("P4 9 2\n" + std::string(4, 'x'))->is_whole);
  EXPECT_FALSE(HeaderOf("P4 9 2\n" + std::string(3, 'x'))->is_whole);
}

TEST(PnmHeader, ClaimsBeyondTheFileAreNotWhole) {
  EXPECT_FALSE(HeaderOf("P6 999999999 999999999 65535\nxyz")->is_whole);
  EXPECT_FALSE(HeaderOf("P6 9999999999 1 255\nxyz"));
  EXPECT_FALSE(HeaderOf("P5 0 5 255\n"));
  EXPECT_FALSE(HeaderOf("P5 -3 5 255\n"));
}

TEST(TiffHeader, BothByteOrdersAreRead) {
  // Three entries: width 5 and height 4 as shorts, one strip of 20 bytes at offset 8.
  const auto big = "MM\0*\0\0\0\x1c"sv, little = "II*\0\x1c\0\0\0"sv;
  const std::string strip(20, 'x');
  const auto header_big = HeaderOf(std::string(big) + strip +
                                   std::string("\0\4"
                                               "\1\0\0\3\0\0\0\1\0\5\0\0"
                                               "\1\1\0\3\0\0\0\1\0\4\0\0"
                                               "\1\x11\0\4\0\0\0\1\0\0\0\10"
                                               "\1\x17\0\4\0\0\0\1\0\0\0\x14"
                                               "\0\0\0\0"sv));
  const auto header_little = HeaderOf(std::string(little) + strip +
                                      std::string("\4\0"
                                                  "\0\1\3\0\1\0\0\0\5\0\0\0"
                                                  "\1\1\3\0\1\0\0\0\4\0\0\0"
                                                  "\x11\1\4\0\1\0\0\0\10\0\0\0"
                                                  "\x17\1\4\0\1\0\0\0\x15\1\0\0"
                                                  "\0\0\0\0"sv));
  ASSERT_TRUE(header_big);
  ASSERT_TRUE(header_little);
  EXPECT_EQ(header_big->width, 5);
  EXPECT_EQ(header_little->height, 4);
  EXPECT_TRUE(header_big->is_whole);
  EXPECT_FALSE(header_little->is_whole);  // its strip ends behind the file
}

TEST(ImageHeader, NothingIsSaidOfAnythingElse) {
  EXPECT_FALSE(HeaderOf(""));
  EXPECT_FALSE(HeaderOf("P"));
  EXPECT_FALSE(HeaderOf("P5"));
  EXPECT_FALSE(HeaderOf("not an image at all\n"));
  EXPECT_FALSE(HeaderOf(std::string("\xff\xd8\xff\xff\xff", 5)));
  EXPECT_FALSE(HeaderOf(std::string("II*\0\xff\xff\xff\xff", 8)));
  EXPECT_FALSE(ReadImageHeader("/nowhere/none.png"));
}

}  // namespace
}  // namespace rigmap
