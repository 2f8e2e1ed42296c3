// How the view of a spot of ground changes when the rig moves.
#pragma once

#include <optional>
#include <vector>

#include "correspondence/stereo_points.h"

namespace rigmap {

// The linear part of the map from pixels around feature `index` of frame a to those of frame b,
// left images, taking the surface there for the plane through the stereo points next to it. The
// feature must have a point. Nothing where the plane is seen edge-on or from behind, or too few
// points have a place.
std::optional<Eigen::Matrix2d> GroundWarp(const std::vector<Feature>& features,
                                          const std::vector<std::optional<StereoPoint>>& points,
                                          int index, const Rigid3& b_from_a, const Camera& camera);

}  // namespace rigmap
