// The ground under a rover: the plane through it, what rises above that, and how sure its slope is.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace rigmap {

// Heights of square blocks of ground, row by row, NaN where too little was seen. The sigma of a
// block is that of its cells, not of their mean: neighbouring cells share the errors of the
// matching windows that saw them.
struct GroundBlocks {
  int columns = 0;
  int rows = 0;
  double block_m = 0.0;
  std::vector<float> height_m;
  std::vector<float> sigma_m;

  std::size_t Index(int column, int row) const {
    return static_cast<std::size_t>(row) * columns + column;
  }
};

// Cells, row by row (NaN: none), put together in blocks of side x side; a block takes a quarter of
// its cells. Side divides columns and rows.
GroundBlocks BlocksOf(const std::vector<float>& height_m, const std::vector<float>& sigma_m,
                      int columns, int side, double cell_m);

// A step is looked for between blocks that are at most so many apart.
inline constexpr int kBlocksOfStep = 2;

struct FootprintLimits {
  double radius_m = 0.5;
  double max_slope_rad = 0.26;
  double level_sigma_rad = 0.01;  // of up about each axis
};

struct FootprintGround {
  double slope_rad = 0.0;    // of the plane through the blocks
  double roughness_m = 0.0;  // standard deviation of the blocks about it, measuring included
  // Largest rise between a block under it and one at most kBlocksOfStep to the right or below: of a
  // smooth slope its own.
  double step_height_m = 0.0;
  double steeper = 0.0;  // probability that the slope exceeds the limit
};

// Of the blocks whose middles lie within the radius of that block's; nothing unless three quarters
// of them were seen. Blocks outside the grid were not. A block's height is that of the plane, plus
// what the ground has of its own there, plus what was measured wrong: weighted least squares with
// the variance of both, the ground's by the residuals (a model of random effects, DerSimonian and
// Laird 1986). The gradient's covariance is that of this fit, plus the level's. Weighted by the
// sigmas alone, errors were four times what they said, on a rendered beach with boulders.
std::optional<FootprintGround> GroundUnder(const GroundBlocks& blocks, int column, int row,
                                           const FootprintLimits& limits);

}  // namespace rigmap
