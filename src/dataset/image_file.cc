#include "dataset/image_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <string_view>

#include "core/error.h"

namespace rigmap {
namespace {

using std::string_view_literals::operator""sv;

constexpr std::string_view kPngStart = "\x89PNG\r\n\x1a\n"sv;
constexpr std::string_view kPngEnd = "\0\0\0\0IEND\xae\x42\x60\x82"sv;
constexpr std::string_view kJpegStart = "\xff\xd8\xff"sv;
constexpr std::string_view kJpegEnd = "\xff\xd9"sv;
// Cameras pad behind the end marker, so it need not stand in the very last bytes.
constexpr std::streamoff kTailBytes = 1024;

bool HasImageExtension(const std::filesystem::path& path) {
  constexpr std::array kExtensions{".png"sv, ".jpg"sv, ".jpeg"sv, ".pgm"sv,
                                   ".ppm"sv, ".tif"sv, ".tiff"sv};
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return std::find(kExtensions.begin(), kExtensions.end(), extension) != kExtensions.end();
}

std::string ReadBytes(std::ifstream& stream, std::streamoff begin, std::streamoff count) {
  std::string bytes(static_cast<std::size_t>(count), '\0');
  stream.clear();
  stream.seekg(begin);
  stream.read(bytes.data(), count);
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  return bytes;
}

bool Decodes(const std::filesystem::path& path) {
  try {
    return !cv::imread(path.string(), cv::IMREAD_UNCHANGED).empty();
  } catch (const cv::Exception&) {
    return false;
  }
}

}  // namespace

std::vector<std::filesystem::path> ListImages(const std::filesystem::path& folder) {
  std::error_code code;
  if (!std::filesystem::is_directory(folder, code)) return {};
  std::vector<std::filesystem::path> images;
  auto entry = std::filesystem::directory_iterator(folder, code);
  for (; !code && entry != std::filesystem::directory_iterator(); entry.increment(code)) {
    const auto& path = entry->path();
    std::error_code ignored;
    const bool hidden = path.filename().string().front() == '.';
    if (!hidden && HasImageExtension(path) && !entry->is_directory(ignored)) images.push_back(path);
  }
  if (code) throw DataError(fmt::format("{}: cannot list: {}", folder.string(), code.message()));
  std::sort(images.begin(), images.end());
  return images;
}

bool IsWholeImage(const std::filesystem::path& path) {
  std::error_code code;
  const auto size = std::filesystem::file_size(path, code);
  std::ifstream stream(path, std::ios::binary);
  if (code || size == 0 || !stream) return false;
  const auto length = static_cast<std::streamoff>(size);
  const std::string head = ReadBytes(stream, 0, std::min<std::streamoff>(length, 8));
  const bool png = head.starts_with(kPngStart);
  if (!png && !head.starts_with(kJpegStart)) return Decodes(path);
  const auto tail_bytes = std::min(length, kTailBytes);
  const std::string tail = ReadBytes(stream, length - tail_bytes, tail_bytes);
  return tail.find(png ? kPngEnd : kJpegEnd) != std::string::npos;
}

}  // namespace rigmap
