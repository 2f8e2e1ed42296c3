// What surfaces look like closer than their meshes tell: grains, specks and small relief, as pure
// functions of place, weakened where a pixel covers too much to show them.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace rigmap {

struct Appearance {
  Eigen::Vector3f albedo;                           // red, green, blue, linear
  Eigen::Vector2f slope = Eigen::Vector2f::Zero();  // of the small relief, towards east and north
};

// Broad patches of moisture and grit, 5 cm to some metres: change of the albedo, of the order 0.1.
float SandTone(const Eigen::Vector2d& position, float extent_m, std::uint32_t seed);

// Adds grains, specks and relief under 3 cm to such a tone. `extent_m`: what one sample stands for.
// `contrast` scales all variation.
Appearance SandAppearance(const Eigen::Vector2d& position, float extent_m, float tone,
                          float contrast, std::uint32_t seed);

// Sand and marram grass of a dune.
Appearance DuneAppearance(const Eigen::Vector2d& position, float extent_m, std::uint32_t seed);

Appearance SeaAppearance(const Eigen::Vector2d& position, float extent_m, std::uint32_t seed);

// What a painted boulder's or a piece of debris' own colour becomes: factor on its albedo.
float RockTone(const Eigen::Vector3d& position, float extent_m, float contrast, std::uint32_t seed);

// Light of the sky from a direction: overcast, brighter towards the horizon and around the sun.
// Directions are unit vectors.
Eigen::Vector3f SkyRadiance(const Eigen::Vector3f& direction, const Eigen::Vector3f& sun,
                            std::uint32_t seed);

}  // namespace rigmap
