// Which pixels are masked out.
#pragma once

#include "core/options.h"

namespace rigmap {

// What each option does and why it has its default: the declaration in mask_options.cc.
struct MaskOptions {
  static constexpr const char* kSection = "masks";

  int black_level = 3;
  int saturation_level = 250;
  int saturation_width_px = 15;
  double saturation_margin_px = 3.0;
  bool sky = true;
  double sky_lowest_share = 0.6;

  OptionFields Fields();
};

}  // namespace rigmap
