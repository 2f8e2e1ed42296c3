// A coloured surface as points.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace rigmap {

struct SurfacePoint {
  Eigen::Vector3f x_in_world = Eigen::Vector3f::Zero();  // metres
  Eigen::Vector3f normal{0.0F, 0.0F, 0.0F};  // unit, towards the cameras; zero where unknown
  std::array<std::uint8_t, 3> rgb{};
  std::uint16_t observations = 0;  // depth pixels that were merged into it
  float sigma_m = 0.0F;            // one standard deviation off the surface
  float grain_m = 0.0F;            // side of the cube that it stands for; 0: unknown

  // Sides are told apart by far more than a float's last digits.
  bool IsCoarserThan(double side_m) const { return grain_m > side_m * (1.0 + 1e-6); }
};

using PointCloud = std::vector<SurfacePoint>;

}  // namespace rigmap
