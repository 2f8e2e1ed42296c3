// Options of the stage `scale`.
#pragma once

#include "core/options.h"

namespace rigmap {

// What each option does and why it has its default: the declaration in scale_options.cc.
struct ScaleOptions {
  static constexpr const char* kSection = "scale";

  double max_sigmas = 5.0;
  double min_tolerated_share = 0.01;

  OptionFields Fields();
};

}  // namespace rigmap
