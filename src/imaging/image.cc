#include "imaging/image.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <ostream>
#include <vector>

#include "core/file.h"
#include "imaging/internal/image_header.h"
#include "imaging/internal/jpeg.h"

namespace rigmap {
namespace {

// Empty if the file is no image, or a damaged one.
cv::Mat TryDecode(const std::string& path, int flags) {
  if (const auto pixels = DecodeJpeg(path, !(flags & cv::IMREAD_COLOR))) return *pixels;
  try {
    return cv::imread(path, flags);
  } catch (const cv::Exception&) {
    return {};
  }
}

// Of a file that is whole as far as its header tells.
cv::Size SizeInHeader(const std::string& path) {
  if (!std::filesystem::is_regular_file(path)) {
    throw DataError(fmt::format("{}: expected an image file, found none", path));
  }
  const auto header = ReadImageHeader(path);
  if (!header) {
    throw UnreadableImage(fmt::format(
        "{}: expected an image, but it cannot be decoded: no header of PNG, JPEG, PGM, PPM or TIFF",
        path));
  }
  if (header->has_fractions || header->sample_bits > 16) {
    throw DataError(fmt::format("{}: expected an image of 8 or 16 bit, found {} of {}", path,
                                header->has_fractions ? "floating-point numbers" : "numbers",
                                header->sample_bits));
  }
  if (!header->is_whole) {
    throw UnreadableImage(fmt::format("{}: expected an image, found one that is cut off", path));
  }
  constexpr std::int64_t kMaxSide = std::numeric_limits<int>::max();
  return {static_cast<int>(std::min(header->width, kMaxSide)),
          static_cast<int>(std::min(header->height, kMaxSide))};
}

void RequireSize(const std::string& path, const Camera& camera, const cv::Size& found) {
  if (found == cv::Size(camera.width, camera.height)) return;
  throw DataError(fmt::format("{}: expected an image of {} x {} pixels, found {} x {}", path,
                              camera.width, camera.height, found.width, found.height));
}

cv::Mat ToEightBit(const cv::Mat& image, int sample_bits) {
  if (image.depth() == CV_8U) return image;
  cv::Mat eight_bit;
  image.convertTo(eight_bit, CV_8U, std::ldexp(1.0, 8 - sample_bits));
  return eight_bit;
}

cv::Mat ReadEightBit(const std::string& path, const Camera& camera, int flags, int sample_bits) {
  // Before decoding: a header of thirty bytes may claim gigabytes.
  RequireSize(path, camera, SizeInHeader(path));
  const cv::Mat image =
      TryDecode(path, flags | cv::IMREAD_ANYDEPTH | cv::IMREAD_IGNORE_ORIENTATION);
  if (image.empty()) {
    throw UnreadableImage(fmt::format("{}: expected an image, but it cannot be decoded", path));
  }
  if (image.depth() != CV_8U && image.depth() != CV_16U) {
    throw DataError(fmt::format("{}: expected an image of 8 or 16 bit, found {}", path,
                                cv::typeToString(image.type())));
  }
  RequireSize(path, camera, image.size());
  return ToEightBit(image, sample_bits);
}

}  // namespace

bool IsWholeImage(const std::filesystem::path& path) {
  const auto header = ReadImageHeader(path);
  return header && header->is_whole;
}

cv::Size ReadSize(const std::string& path) { return SizeInHeader(path); }

cv::Mat ReadGrey(const std::string& path, const Camera& camera, int sample_bits) {
  return ReadEightBit(path, camera, cv::IMREAD_GRAYSCALE, sample_bits);
}

cv::Mat ReadColour(const std::string& path, const Camera& camera, int sample_bits) {
  return ReadEightBit(path, camera, cv::IMREAD_COLOR, sample_bits);
}

std::optional<int> SampleBitsNeeded(const std::string& path, const Camera& camera) {
  const auto header = ReadImageHeader(path);
  if (!header || !header->is_whole || header->sample_bits <= 8) return std::nullopt;
  if (header->width != camera.width || header->height != camera.height) return std::nullopt;
  // Without an alpha channel.
  const cv::Mat image =
      TryDecode(path, cv::IMREAD_ANYDEPTH | cv::IMREAD_ANYCOLOR | cv::IMREAD_IGNORE_ORIENTATION);
  if (image.empty() || image.depth() != CV_16U) return std::nullopt;
  double largest = 0.0;
  cv::minMaxIdx(image.reshape(1), nullptr, &largest);
  for (const int bits : {10, 12, 14}) {
    if (largest < std::ldexp(1.0, bits)) return bits;
  }
  return 16;
}

void WriteImage(const std::filesystem::path& path, const cv::Mat& image) {
  std::vector<uchar> bytes;
  if (!cv::imencode(path.extension().string(), image, bytes)) {
    throw DataError(fmt::format("{}: cannot encode the image", path.string()));
  }
  WriteFileAtomically(path, [&](std::ostream& stream) {
    stream.write(reinterpret_cast<const char*>(bytes.data()),
                 static_cast<std::streamsize>(bytes.size()));
  });
}

}  // namespace rigmap
