// Least-squares alignment of corresponding points.
#pragma once

#include <span>

#include "geometry/rigid3.h"

namespace rigmap {

// The similarity that minimises sum |to_i - (s R from_i + t)|^2 (Umeyama 1991); with_scale false
// holds s at 1. Collinear points leave the rotation about their line at an arbitrary value.
// Throws std::invalid_argument unless both spans have the same size, at least 3 points.
Sim3 AlignPoints(std::span<const Eigen::Vector3d> from, std::span<const Eigen::Vector3d> to,
                 bool with_scale);

}  // namespace rigmap
