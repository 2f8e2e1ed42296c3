// How COLMAP is made to pose the keyframes.
#pragma once

#include <array>

#include "core/enum_names.h"

namespace rigmap {

enum class MappingMethod { kSeeded, kTriangulate, kUnseeded, kNone };
constexpr auto NamesOf(MappingMethod) {
  return std::array{"seeded", "triangulate", "unseeded", "none"};
}

}  // namespace rigmap
