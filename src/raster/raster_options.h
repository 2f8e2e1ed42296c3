// How a part's cloud becomes rasters and pictures.
#pragma once

#include "core/options.h"

namespace rigmap {

// What each option does and why it has its default: the declarations in raster_options.cc.

struct RasterOptions {
  static constexpr const char* kSection = "raster";

  int max_hole_cells = 3;

  OptionFields Fields();
};

struct FootprintOptions {
  static constexpr const char* kSection = "raster";

  double footprint_m = 0.0;
  double max_slope_deg = 15.0;
  double level_sigma_deg = 0.57;

  OptionFields Fields();
};

struct PictureOptions {
  static constexpr const char* kSection = "raster";

  int picture_px = 1600;

  OptionFields Fields();
};

}  // namespace rigmap
