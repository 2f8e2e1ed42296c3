// How the view of a spot of ground changes when the rig moves.
#pragma once

#include <optional>
#include <vector>

#include "correspondence/patch_alignment.h"
#include "correspondence/stereo_points.h"

namespace rigmap {

// The plane that the surface around a feature is taken for.
struct GroundPatch {
  int frame = 0;
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  // px, left image of the frame
  Eigen::Vector3d x = Eigen::Vector3d::Zero();       // a point of the plane, left camera axes, m
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // unit length
};

// Through the stereo points next to feature `index`, which must have one; around its pixel,
// rounded. Nothing where too few points have a place.
std::optional<GroundPatch> GroundAround(const std::vector<Feature>& features,
                                        const std::vector<std::optional<StereoPoint>>& points,
                                        int index, int frame);

// By what share the plane's depth changes from the patch's centre to the next column and row.
Eigen::Array2d DepthChange(const GroundPatch& patch, const Camera& camera);

// The map from pixels around the patch's centre to those of frame b, left images, to second order;
// its position is where the centre goes to. Nothing where the plane is seen edge-on or from behind.
std::optional<PatchWarp> GroundWarp(const GroundPatch& patch, const Rigid3& b_from_a,
                                    const Camera& camera);

}  // namespace rigmap
