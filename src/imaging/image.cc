#include "imaging/image.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <string_view>

namespace rigmap {
namespace {

using std::string_view_literals::operator""sv;

constexpr std::string_view kPngStart = "\x89PNG\r\n\x1a\n"sv;
constexpr std::string_view kPngEnd = "\0\0\0\0IEND\xae\x42\x60\x82"sv;
constexpr std::string_view kJpegStart = "\xff\xd8\xff"sv;
constexpr std::string_view kJpegEnd = "\xff\xd9"sv;
// Cameras pad behind the end marker, so it need not stand in the very last bytes.
constexpr std::streamoff kTailBytes = 1024;

std::string ReadBytes(std::ifstream& stream, std::streamoff begin, std::streamoff count) {
  std::string bytes(static_cast<std::size_t>(count), '\0');
  stream.clear();
  stream.seekg(begin);
  stream.read(bytes.data(), count);
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  return bytes;
}

// Whether a PNG or JPEG has its end marker; nothing for any other file. Decoders fill what is cut
// off with grey, without a word.
std::optional<bool> HasEnd(const std::filesystem::path& path) {
  std::error_code code;
  const auto size = std::filesystem::file_size(path, code);
  std::ifstream stream(path, std::ios::binary);
  if (code || !stream) return std::nullopt;
  const auto length = static_cast<std::streamoff>(size);
  const std::string head = ReadBytes(stream, 0, std::min<std::streamoff>(length, 8));
  const bool png = head.starts_with(kPngStart);
  if (!png && !head.starts_with(kJpegStart)) return std::nullopt;
  const auto tail_bytes = std::min(length, kTailBytes);
  const std::string tail = ReadBytes(stream, length - tail_bytes, tail_bytes);
  return tail.find(png ? kPngEnd : kJpegEnd) != std::string::npos;
}

// Empty if the file is no image.
cv::Mat TryDecode(const std::string& path, int flags) {
  try {
    return cv::imread(path, flags);
  } catch (const cv::Exception&) {
    return {};
  }
}

cv::Mat Decode(const std::string& path, int flags) {
  if (!std::filesystem::is_regular_file(path)) {
    throw DataError(fmt::format("{}: expected an image file, found none", path));
  }
  if (!HasEnd(path).value_or(true)) {
    throw UnreadableImage(fmt::format("{}: expected an image, found one that is cut off", path));
  }
  const cv::Mat image =
      TryDecode(path, flags | cv::IMREAD_ANYDEPTH | cv::IMREAD_IGNORE_ORIENTATION);
  if (image.empty()) {
    throw UnreadableImage(fmt::format("{}: expected an image, but it cannot be decoded", path));
  }
  if (image.depth() != CV_8U && image.depth() != CV_16U) {
    throw DataError(fmt::format("{}: expected an image of 8 or 16 bit, found {}", path,
                                cv::typeToString(image.type())));
  }
  return image;
}

cv::Mat ToEightBit(const cv::Mat& image) {
  if (image.depth() == CV_8U) return image;
  double largest = 0.0;
  cv::minMaxIdx(image.reshape(1), nullptr, &largest);
  cv::Mat eight_bit;
  image.convertTo(eight_bit, CV_8U, largest < 4096.0 ? 1.0 / 16.0 : 1.0 / 256.0);
  return eight_bit;
}

cv::Mat ReadEightBit(const std::string& path, const Camera& camera, int flags) {
  const cv::Mat image = Decode(path, flags);
  if (image.cols != camera.width || image.rows != camera.height) {
    throw DataError(fmt::format("{}: expected an image of {} x {} pixels, found {} x {}", path,
                                camera.width, camera.height, image.cols, image.rows));
  }
  return ToEightBit(image);
}

}  // namespace

bool IsWholeImage(const std::filesystem::path& path) {
  const auto has_end = HasEnd(path);
  return has_end ? *has_end : !TryDecode(path.string(), cv::IMREAD_UNCHANGED).empty();
}

cv::Size ReadSize(const std::string& path) { return Decode(path, cv::IMREAD_GRAYSCALE).size(); }

cv::Mat ReadGrey(const std::string& path, const Camera& camera) {
  return ReadEightBit(path, camera, cv::IMREAD_GRAYSCALE);
}

cv::Mat ReadColour(const std::string& path, const Camera& camera) {
  return ReadEightBit(path, camera, cv::IMREAD_COLOR);
}

}  // namespace rigmap
