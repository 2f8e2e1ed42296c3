// Where a small grey patch lies in another image, to a few hundredths of a pixel.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "correspondence/patch_warp.h"

namespace rigmap {

// Grey pixels that somebody else owns; row y starts at data + y * stride. Pixel centres are at
// integers.
struct GreyView {
  const std::uint8_t* data = nullptr;
  int width = 0, height = 0;
  int stride = 0;
};

struct PatchAlignmentOptions {
  // Of the window, to either side of its centre; 13 x 13 pixels hold the nine parameters on sand.
  int half_width_px = 6, half_height_px = 6;
  int max_iterations = 20;
  double converged_px = 0.01;
  double max_shift_px = 3.0;  // a window that moves further has found something else
  double max_stretch = 0.5;   // largest change of the linear part (any entry) from its start
};

struct PatchAlignment {
  PatchWarp warp;
  double correlation = 0.0;  // of the windows without their planes, -1 to 1
  double sigma_px = 0.0;     // of the position along its worse direction, from residual and texture
};

// Aligns the window around the integer pixel (centre_x, centre_y) of `source` with `target`, under
// an affine warp and a free gain, offset and slope of brightness: inverse compositional
// Gauss-Newton (Baker and Matthews 2004), with the mean plane taken off both windows and unit
// variance given to the rest, and the template made as sharp as the target shows it. Stray light
// and vignetting differ from view to view by just such planes. Nothing where the window leaves an
// image, has no texture in two directions or does not converge.
std::optional<PatchAlignment> AlignPatch(const GreyView& source, const Eigen::Vector2i& centre,
                                         const GreyView& target, const PatchWarp& start,
                                         const PatchAlignmentOptions& options);

}  // namespace rigmap
