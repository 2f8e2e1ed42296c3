#include "imaging/internal/jpeg.h"

#include <turbojpeg.h>

#include <array>
#include <fstream>
#include <memory>
#include <regex>
#include <string>

#include "core/file.h"

namespace rigmap {
namespace {

// Of a file of another kind no more is read than this.
bool IsJpeg(const std::filesystem::path& path) {
  std::array<char, 3> start{};
  std::ifstream stream(path, std::ios::binary);
  stream.read(start.data(), start.size());
  return stream && start == std::array{'\xff', '\xd8', '\xff'};
}

using Decoder = std::unique_ptr<void, decltype(&tjDestroy)>;

// Of an image that reached its end: cameras fill up words.
bool IsPadding(const std::string& warning) {
  static const std::regex kTooMany(
      "Corrupt JPEG data: ([0-9]+) extraneous bytes before marker 0xd9");
  constexpr int kMostPadding = 8;
  std::smatch found;
  return std::regex_search(warning, found, kTooMany) && found[1].length() == 1 &&
         std::stoi(found[1]) <= kMostPadding;
}

bool IsDecoded(const Decoder& decoder, const std::string& bytes, cv::Mat& pixels, int flags) {
  return tjDecompress2(decoder.get(), reinterpret_cast<const unsigned char*>(bytes.data()),
                       bytes.size(), pixels.data, pixels.cols, static_cast<int>(pixels.step[0]),
                       pixels.rows, pixels.channels() == 1 ? TJPF_GRAY : TJPF_BGR, flags) == 0;
}

}  // namespace

std::optional<cv::Mat> DecodeJpeg(const std::filesystem::path& path, bool as_grey) {
  if (!IsJpeg(path)) return std::nullopt;
  const std::string bytes = ReadBytes(path);
  const Decoder decoder(tjInitDecompress(), &tjDestroy);
  int width = 0, height = 0, subsampling = 0, colours = 0;
  if (tjDecompressHeader3(decoder.get(), reinterpret_cast<const unsigned char*>(bytes.data()),
                          bytes.size(), &width, &height, &subsampling, &colours) != 0) {
    return cv::Mat();
  }
  if (colours == TJCS_CMYK || colours == TJCS_YCCK) return std::nullopt;
  cv::Mat pixels(height, width, as_grey ? CV_8UC1 : CV_8UC3);
  if (IsDecoded(decoder, bytes, pixels, TJFLAG_STOPONWARNING)) return pixels;
  const bool is_padded =
      tjGetErrorCode(decoder.get()) == TJERR_WARNING && IsPadding(tjGetErrorStr2(decoder.get()));
  // That the second time it only warns of what it warned of before.
  if (is_padded) IsDecoded(decoder, bytes, pixels, 0);
  return is_padded ? pixels : cv::Mat();
}

}  // namespace rigmap
