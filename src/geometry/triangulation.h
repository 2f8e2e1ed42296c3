// Points from rays.
#pragma once

#include <optional>
#include <span>

#include "geometry/rigid3.h"

namespace rigmap {

// A bearing seen from a known pose: normalised image coordinates (x/z, y/z).
struct View {
  Rigid3 camera_from_world;
  Eigen::Vector2d normalised = Eigen::Vector2d::Zero();
};

// The point that minimises the sum of squared distances to all rays, then one that minimises the
// normalised reprojection error (Gauss-Newton from there). Nothing if it lies behind a camera or
// the rays are parallel.
std::optional<Eigen::Vector3d> Triangulate(std::span<const View> views);

// The same for one stereo pair, in left camera axes, metres if the rig is in metres.
std::optional<Eigen::Vector3d> TriangulateStereo(const Rigid3& right_from_left,
                                                 const Eigen::Vector2d& left_normalised,
                                                 const Eigen::Vector2d& right_normalised);

}  // namespace rigmap
