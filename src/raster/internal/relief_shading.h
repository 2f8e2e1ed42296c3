// Colours of a surface with its relief made visible.
#pragma once

#include <opencv2/core.hpp>

#include "raster/upper_surface.h"

namespace rigmap {

// Draws the cells in which something was seen into `picture` (of the grid's size), the others stay.
// A cell is the lighter the higher it lies above its surroundings and the darker the lower: stones
// stand out, whatever the light was (unsharp masking of the depth buffer, Luft, Colditz, Deussen
// 2006). How high counts depends on `grain_m`, the side of the finest of the surface's cubes.
void DrawShaded(const SurfaceGrid& surface, double grain_m, double px_per_m, cv::Mat3b picture);

}  // namespace rigmap
