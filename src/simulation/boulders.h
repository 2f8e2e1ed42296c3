// Grey boulders in three sizes, as the beach of Katwijk had them made of cardboard.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "simulation/mesh.h"
#include "simulation/terrain.h"

namespace rigmap {

struct Boulder {
  std::string size;  // small, medium, large
  double height_m = 0.0, width_m = 0.0, yaw_rad = 0.0;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // at the sand line
  Eigen::Vector3d top = Eigen::Vector3d::Zero();     // the highest point, height_m above centre
  Mesh mesh;                                         // closed, in the world, foot in the sand
};

// Up to `per_100_m2` boulders for each hundred square metres within 7 m of the outline, apart from
// each other; none nearer to any of the outline's places than its half width plus 0.95 m, so that
// the rover passes.
std::vector<Boulder> ScatterBoulders(const Terrain& terrain,
                                     std::span<const Eigen::Vector2d> outline, double per_100_m2,
                                     std::uint64_t seed);

}  // namespace rigmap
