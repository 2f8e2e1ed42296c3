// Enumerations whose values have names in files and messages. The names stand once, beside the
// enumeration, in its order:
//
//   enum class DenseMethod { kSgm, kBm };
//   constexpr auto NamesOf(DenseMethod) { return std::array{"sgm", "bm"}; }
#pragma once

#include <array>
#include <cstddef>

namespace rigmap {

template <class Enum>
constexpr const char* NameOf(Enum value) {
  return NamesOf(value)[static_cast<std::size_t>(value)];
}

}  // namespace rigmap
