// The pair of parallel views that a stereo rig becomes once rectified.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "geometry/rigid3.h"

namespace rigmap {

// Both rectified views have parallel axes: x along the baseline (left to right), z the mean
// viewing direction made perpendicular to it. A point at depth z (rectified axes) has normalised
// coordinates (x, y) in the left view and (x - baseline_m / z, y) in the right one.
struct RectifiedAxes {
  Eigen::Quaterniond rectified_from_left;
  Eigen::Quaterniond rectified_from_right;
  double baseline_m = 0.0;
};

// For a rig whose second camera stands beside the first. Follows Fusiello et al. 2000, with the
// mean of both optical axes in place of the left one.
RectifiedAxes Rectify(const Rigid3& right_from_left);

// Normalised coordinates turned by `rotation`; z of the turned ray must be positive.
inline Eigen::Vector2d Turn(const Eigen::Quaterniond& rotation, const Eigen::Vector2d& normalised) {
  return (rotation * normalised.homogeneous()).eval().hnormalized();
}

}  // namespace rigmap
