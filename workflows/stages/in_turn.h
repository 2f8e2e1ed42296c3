// Two ways to one product, as a recipe states them.
#pragma once

#include <string>

#include "core/enum_names.h"

namespace rigmap {

// The other way is tried where what the planned one made fails its gates, and taken if it passes.
template <class Way>
struct InTurn {
  Way planned{};
  Way otherwise{};
};

template <class Way>
std::string OptionsText(const InTurn<Way>& ways) {
  return std::string(NameOf(ways.planned)) + ", else " + NameOf(ways.otherwise);
}

}  // namespace rigmap
