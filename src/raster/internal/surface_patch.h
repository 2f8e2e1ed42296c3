// What a point of a map stands for: a piece of the surface, as large as its cube.
#pragma once

#include <Eigen/Core>
#include <array>

#include "raster/upper_surface.h"
#include "scene/point_cloud.h"

namespace rigmap {

// A parallelogram in world, metres.
struct SurfacePatch {
  Eigen::Vector3d corner;
  std::array<Eigen::Vector3d, 2> edges;
};

// The point's plane where it crosses its cube, whose corners are at multiples of its grain, along
// the axis that the normal is nearest to: patches of a plane touch, wherever in their cubes the
// points lie. The point must have a normal and a grain.
SurfacePatch PatchOf(const SurfacePoint& point);

// Height of the point's plane at x and y in its cube, no further off than the cube is high; that of
// the point where it is steeper than 45 degrees.
double HeightAt(const SurfacePoint& point, const Eigen::Vector2d& x_in_world);

// What the point says at a height about cells of this size. Where it is coarser, only its share of
// the observations weighs, and it may lie two sigmas lower.
CellSample SampleOf(const SurfacePoint& point, double height_m, double cell_m);

}  // namespace rigmap
