// What one pixel covers on a surface that it sees at a slant.
#pragma once

#include <Eigen/Core>
#include <array>

namespace rigmap {

// From a pixel's unit ray to those of its neighbours to the right and below.
using RaySteps = std::array<Eigen::Vector3f, 2>;

// The lens spreads a point before pixels sample it, falling off evenly up to so far from its
// middle, and what is finer than two pixels with it. Were it sampled, it would move with the pixels
// instead of with the ground.
inline constexpr float kSpotReach_px = 1.5f;

// Of a pixel without that spot, an ellipse: its longer axis, and the width across it.
struct PixelFootprint {
  Eigen::Vector3f along = Eigen::Vector3f::Zero();
  float along_m = 0.0f, across_m = 0.0f;

  // How many places along the longer axis stand for the spot's width, 3 to 8.
  int Samples() const;
  // Of what stands for one of them.
  float Extent_m() const;
};

// On a plane of unit `normal` which the ray meets after `distance_m`.
PixelFootprint FootprintOn(const Eigen::Vector3f& direction, const RaySteps& steps,
                           const Eigen::Vector3f& normal, float distance_m);

}  // namespace rigmap
