// How a mapped rock differs from the true one in place and size.
#pragma once

#include <Eigen/Core>
#include <span>

namespace rigmap {

// A mapped point and the tangent plane of the true point next to it; metres.
struct RockMatch {
  Eigen::Vector3d x_true, normal, x_mapped;
};

struct RockDeformation {
  double shift_m = 0.0;           // length of the translation that best lays the truth on the map
  Eigen::Vector3d stretch;        // along each axis; 1 is true
  Eigen::Vector3d sigma_stretch;  // how well each is determined, one standard deviation
};

// Least squares over the distances from the planes, with Huber's weights. The stretch, about
// `centre` and along the rows of `axes` (orthonormal), is found together with a translation of its
// own; the shift by itself, with the weights of that. What the matches leave open stays unmoved.
// Needs six matches or more.
RockDeformation FitDeformation(std::span<const RockMatch> matches, const Eigen::Vector3d& centre,
                               const Eigen::Matrix3d& axes);

}  // namespace rigmap
