// Clouds laid over each other, without asking whether they agree.
#pragma once

#include <cstddef>
#include <functional>

#include "fusion/depth_fusion.h"
#include "scene/point_cloud.h"

namespace rigmap {

// Points of all clouds (world axes), merged on a grid of `grid_m`: one point per cube, the mean of
// those in it weighted by 1 / sigma_m^2. Each cloud is asked for once, in order. Memory does not
// grow with their number: kKeptVoxels cubes and one cloud. Throws DataError when `target.scratch`
// cannot be written.
void MergeClouds(std::size_t count, const std::function<PointCloud(std::size_t)>& cloud_of,
                 double grid_m, const FusionTarget& target);

}  // namespace rigmap
