#include "raster/raster_options.h"

namespace rigmap {

OptionFields RasterOptions::Fields() {
  return {
      {"max_hole_cells", &max_hole_cells, "cells", AtLeast(0).UpTo(100),
       "Widest and longest hole that is filled. Three: a voxel that missed its few observations, "
       "and its neighbours. Wider holes are shadows and far ground, where a value would be a "
       "guess."},
  };
}

OptionFields PictureOptions::Fields() {
  return {
      {"picture_px", &picture_px, "px", AtLeast(1000).UpTo(4096),
       "Longest side of a picture: fits a screen and a page."},
  };
}

}  // namespace rigmap
