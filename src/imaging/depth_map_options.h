// Whether depth maps are written for other programs.
#pragma once

#include "core/options.h"

namespace rigmap {

struct DepthMapOptions {
  static constexpr const char* kSection = "dense";

  bool depth_maps = false;

  OptionFields Fields();
};

}  // namespace rigmap
