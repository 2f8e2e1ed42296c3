// How a part's cloud becomes rasters and pictures.
#pragma once

#include "core/options.h"

namespace rigmap {

struct RasterOptions {
  // Widest and longest hole (cells) that is filled. Three: a voxel that missed its few
  // observations, and its neighbours; wider holes are shadows and far ground, where a value would
  // be a guess.
  int max_hole_cells = 3;

  OptionFields Fields() { return {{"max_hole_cells", &max_hole_cells}}; }
  void Validate() const;  // throws UsageError
};

struct PictureOptions {
  // Longest side of a picture (px): fits a screen and a page.
  int picture_px = 1600;

  OptionFields Fields() { return {{"picture_px", &picture_px}}; }
  void Validate() const;  // throws UsageError
};

}  // namespace rigmap
