// Shells, pebbles and driftwood strewn over the sand.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "simulation/mesh.h"
#include "simulation/terrain.h"

namespace rigmap {

// Closed meshes of 1 to 12 cm, half in the sand, `per_m2` of them within `reach_m` of the outline.
std::vector<Mesh> StrewDebris(const Terrain& terrain, std::span<const Eigen::Vector2d> outline,
                              double reach_m, double per_m2, std::uint64_t seed);

}  // namespace rigmap
