#include "dataset/internal/image_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <string_view>

#include "core/error.h"

namespace rigmap {
namespace {

using std::string_view_literals::operator""sv;

bool HasImageExtension(const std::filesystem::path& path) {
  constexpr std::array kExtensions{".png"sv, ".jpg"sv, ".jpeg"sv, ".pgm"sv,
                                   ".ppm"sv, ".tif"sv, ".tiff"sv};
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return std::find(kExtensions.begin(), kExtensions.end(), extension) != kExtensions.end();
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
    const auto type = entry->status(ignored).type();
    // A link that leads nowhere stands for an image that is missed.
    const bool file = type == std::filesystem::file_type::regular ||
                      type == std::filesystem::file_type::not_found;
    if (!hidden && HasImageExtension(path) && file) images.push_back(path);
  }
  if (code) throw DataError(fmt::format("{}: cannot list: {}", folder.string(), code.message()));
  std::sort(images.begin(), images.end());
  return images;
}

}  // namespace rigmap
