// Narrow holes in a surface that was seen from above.
#pragma once

#include <cstddef>

#include "raster/upper_surface.h"

namespace rigmap {

// Fills the empty cells over which no empty disc of more than `max_width_cells` across can be laid
// (morphological closing): slits of that width, however long, and what is as small. The grid's
// surroundings count as empty. What a straight line bounds stays as it is, so that nothing grows
// over an outer edge or into a wide hole.
//
// The value is linear between both ends of the run of empty cells through the cell, along row,
// column and diagonals, weighted by one over the run's length squared: right on a plane; so is the
// sigma, and the count is 0. A narrow hole across a step becomes a slope. A cell depends on those
// up to FillReach(max_width_cells) away. Returns how many were filled.
std::size_t FillPinholes(SurfaceGrid& grid, int max_width_cells);

int FillReach(int max_width_cells);

}  // namespace rigmap
