// A world two metres long that is built in a moment, and a stereo rover that drives through it.
#pragma once

#include <vector>

#include "scene/rig.h"
#include "simulation/world.h"

namespace rigmap {

inline constexpr double kSmallCell_m = 0.05;   // of its sand
inline constexpr double kSmallNoise_m = 1e-4;  // of places found by single-precision rays

// Two metres eastwards from the origin.
std::vector<Eigen::Vector2d> SmallOutline();

// With boulders, debris and a coarse mesh; built once for all tests.
const World& SmallWorld();

// world_from_left every 25 cm along the outline, the camera 1.1 m above the sand, 18 degrees down.
std::vector<Rigid3> SmallDrive();

}  // namespace rigmap
