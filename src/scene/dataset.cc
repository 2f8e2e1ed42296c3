#include "scene/dataset.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

namespace rigmap {

std::string ImageName(const StereoFrame& frame, Eye eye) {
  std::string extension = std::filesystem::path(frame.PathOf(eye)).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return (eye == Eye::kLeft ? "left/" : "right/") + std::to_string(frame.stamp_ns) + extension;
}

}  // namespace rigmap
