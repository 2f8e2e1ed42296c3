// What one pixel covers on a surface that it sees at a slant.
#pragma once

#include <Eigen/Core>
#include <array>

namespace rigmap {

// From a pixel's unit ray to those of its neighbours to the right and below.
using RaySteps = std::array<Eigen::Vector3f, 2>;

// An ellipse: its longer axis, and the width across it.
struct PixelFootprint {
  Eigen::Vector3f along = Eigen::Vector3f::Zero();
  float along_m = 0.0f, across_m = 0.0f;

  // How many places along the longer axis stand for the whole, at most 4.
  int Samples() const;
};

// On a plane of unit `normal` which the ray meets after `distance_m`.
PixelFootprint FootprintOn(const Eigen::Vector3f& direction, const RaySteps& steps,
                           const Eigen::Vector3f& normal, float distance_m);

}  // namespace rigmap
