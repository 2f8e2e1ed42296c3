// Where a small grey patch lies in another image, to a few hundredths of a pixel.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

namespace rigmap {

// Grey pixels that somebody else owns; row y starts at data + y * stride. Pixel centres are at
// integers.
struct GreyView {
  const std::uint8_t* data = nullptr;
  int width = 0, height = 0;
  int stride = 0;
};

// Maps offsets u from the template's centre into the target: x = position + linear (u + bend q),
// q = (u.x u.x, u.x u.y, u.y u.y).
struct PatchWarp {
  Eigen::Matrix2d linear = Eigen::Matrix2d::Identity();
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  // px in the target
  // 1/px; what perspective and lenses add, known beforehand: it is not searched. Left out it would
  // draw windows aside, all of a frame the same way, by some hundredths of a pixel.
  Eigen::Matrix<double, 2, 3> bend = Eigen::Matrix<double, 2, 3>::Zero();

  Eigen::Vector2d operator*(const Eigen::Vector2d& u) const { return position + linear * Bent(u); }
  Eigen::Vector2d Bent(const Eigen::Vector2d& u) const {
    return u + bend * Eigen::Vector3d(u.x() * u.x(), u.x() * u.y(), u.y() * u.y());
  }
};

struct PatchAlignmentOptions {
  int radius_px = 6;  // of the window; 13 x 13 pixels hold the nine parameters on sand
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
// variance given to the rest. Stray light and vignetting differ from view to view by just such
// planes. Nothing where the window leaves an image, has no texture in two directions or does not
// converge.
std::optional<PatchAlignment> AlignPatch(const GreyView& source, const Eigen::Vector2i& centre,
                                         const GreyView& target, const PatchWarp& start,
                                         const PatchAlignmentOptions& options);

}  // namespace rigmap
