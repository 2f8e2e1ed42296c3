// How a part's cloud becomes rasters and pictures.
#pragma once

#include "core/options.h"

namespace rigmap {

struct RasterOptions {
  // Side of a cell (m). That of the voxels in which the cloud was merged: finer leaves holes
  // between the points, coarser loses detail; hence no option of its own.
  double cell_m = 0.01;
  // Widest and longest hole (cells) that is filled. Three: a voxel that missed its few
  // observations, and its neighbours; wider holes are shadows and far ground, where a value would
  // be a guess.
  int max_hole_cells = 3;
  // Longest side of a picture (px): fits a screen and a page.
  int picture_px = 1600;

  OptionFields Fields() {
    return {{"max_hole_cells", &max_hole_cells}, {"picture_px", &picture_px}};
  }
  void Validate() const;  // throws UsageError
};

}  // namespace rigmap
