// Whether a map shows a surface twice.
#pragma once

#include <Eigen/Core>
#include <span>

namespace rigmap {

// Of the surface's cubes of 3 cm that have four points of the map or more, the share in which their
// offsets from the surface fall apart: a gap of over 1 cm with a fifth of the cube's points, two at
// least, on either side. `x_true`: the surface's point next to each; in parallel. 0 without such
// cubes.
double ShareInTwoSheets(std::span<const Eigen::Vector3d> x_true, std::span<const double> offset_m);

}  // namespace rigmap
