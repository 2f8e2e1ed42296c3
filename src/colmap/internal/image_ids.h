// The numbers by which COLMAP knows cameras and images. Of this room only.
#pragma once

#include <cstdint>

#include "scene/sparse_model.h"

namespace rigmap {

// 1 left, 2 right.
constexpr std::uint32_t CameraIdOf(Eye eye) { return eye == Eye::kLeft ? 1U : 2U; }

// Frame k has the images 2k + 1 (left) and 2k + 2 (right).
constexpr std::uint32_t ImageIdOf(const ImageRef& image) {
  return 2U * static_cast<std::uint32_t>(image.frame) + CameraIdOf(image.eye);
}

// The inverse, for ids from 1.
constexpr ImageRef ImageOf(std::uint32_t id) {
  return {static_cast<int>((id - 1U) / 2U), id % 2U == 1U ? Eye::kLeft : Eye::kRight};
}

}  // namespace rigmap
