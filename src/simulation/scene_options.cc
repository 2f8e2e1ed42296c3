#include "simulation/scene_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "core/error.h"

namespace rigmap {

Eigen::Vector3d SceneOptions::SunDirection() const {
  return {std::cos(sun_elevation_rad) * std::cos(sun_azimuth_rad),
          std::cos(sun_elevation_rad) * std::sin(sun_azimuth_rad), std::sin(sun_elevation_rad)};
}

SceneOptions MakeScene(const std::string& name, std::uint64_t seed) {
  SceneOptions scene;
  scene.name = name;
  scene.seed = scene.terrain.seed = seed;
  if (name == "rocks") {
    scene.boulders_per_100_m2 = 14.0;
    scene.debris_per_m2 = 14.0;
  } else if (name == "flat-sand") {
    scene.terrain = {.undulation_m = 0.006,
                     .ripple_m = 0.002,
                     .roughness_m = 0.002,
                     .footprint_trails = 0.0,
                     .tyre_tracks = 0.0,
                     .seed = seed};
    scene.boulders_per_100_m2 = scene.debris_per_m2 = 0.0;
    scene.contrast = 0.6;
  } else if (name != "beach") {
    throw UsageError(
        fmt::format("scene: expected one of {}, found '{}'", fmt::join(kSceneNames, ", "), name));
  }
  return scene;
}

}  // namespace rigmap
