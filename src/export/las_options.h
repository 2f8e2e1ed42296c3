// Whether a LAS file is wanted.
#pragma once

#include "core/options.h"

namespace rigmap {

// What each option does and why it has its default: the declaration in las_options.cc.
struct LasOptions {
  static constexpr const char* kSection = "georeference";

  bool las = true;

  OptionFields Fields();
};

}  // namespace rigmap
