// From where a rock was seen.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "export/tum.h"

namespace rigmap {

// In rows: the horizontal direction in which the poses look at the points, to its left, up. Each
// pose within 6.5 m that has their middle within 40 degrees of its axis counts by 1 / z^4, as the
// variance of its depths goes: a rock beside the path is seen from far behind it, hardly from the
// nearest pose. Without such poses all count, by 1 / distance^4. Neither list may be empty.
Eigen::Matrix3d ViewAxes(std::span<const Eigen::Vector3d> points, std::span<const TumPose> poses);

}  // namespace rigmap
