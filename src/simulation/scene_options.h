// What a scene is made of, by name.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "simulation/terrain.h"

namespace rigmap {

// Scenes: beach (like traverse 3), flat-sand (no rock, no relief over 2 cm), rocks (many).
inline const std::vector<std::string> kSceneNames{"beach", "flat-sand", "rocks"};

struct SceneOptions {
  std::string name = "beach";
  TerrainOptions terrain;
  double boulders_per_100_m2 = 6.5;
  double debris_per_m2 = 9.0;
  double contrast = 1.0;  // of the sand's albedo; 1: as measured against beach-dev
  double sun_elevation_rad = 0.33;
  double sun_azimuth_rad = -2.48;  // counter-clockwise from east: where the sun stands
  double sand_cell_m = 0.01;       // of the fine sand's mesh
  int markers = 0;                 // discs laid beside the path to check the cameras with
  std::uint64_t seed = 1;

  Eigen::Vector3d SunDirection() const;  // unit, towards the sun
};

// Throws UsageError for an unknown name.
SceneOptions MakeScene(const std::string& name, std::uint64_t seed);

}  // namespace rigmap
