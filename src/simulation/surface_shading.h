// How much light falls on each place of the world: worked out once, looked up by every view.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "simulation/boulders.h"
#include "simulation/mesh.h"
#include "simulation/ray_scene.h"
#include "simulation/sand_tiles.h"

namespace rigmap {

struct Light {
  float sun = 0.0f;      // share of the sun that is visible times the cosine of its incidence
  float visible = 0.0f;  // share of the sun that is visible
  float sky = 0.0f;      // share of the sky that is visible
};

// Of the sand: also its broad patches of moisture and grit, as a change of the albedo.
struct SandState {
  Light light;
  float tone = 0.0f;
};

struct LightSource {
  Eigen::Vector3f sun_direction;    // unit, towards it
  const RayScene* scene = nullptr;  // what casts shadows
};

// Light at the vertices of a mesh in the world.
std::vector<Light> LightOnMesh(const Mesh& mesh, const LightSource& source);

// The state of the sand: per tile a pyramid of means, so that a far pixel sees the mean over what
// it covers. Thread-safe.
class SandStates {
 public:
  struct Surroundings {
    const SandHeights& heights;
    const std::vector<Boulder>& boulders;
    const LightSource& source;
    std::uint32_t seed;  // of SandTone
  };
  // `tiles` must outlive this.
  SandStates(const SandTiles& tiles, const Surroundings& around);

  // Mean over about `extent_m` around a place of a tile; a place beyond the tile is looked up in
  // the one that holds it.
  SandState At(std::uint32_t tile, const Eigen::Vector2d& position, float extent_m) const;

 private:
  using Texel = Eigen::Vector4f;  // sun, visible, sky, tone
  static constexpr int kLevels = 6;

  std::vector<Texel> TexelsOf(std::size_t tile, const Surroundings& around) const;
  void AddMeans(std::vector<Texel>& texels) const;
  Texel Sample(std::uint32_t tile, const Eigen::Vector2d& position, int level) const;

  const SandTiles& tiles_;
  std::size_t texels_per_tile_ = 0;
  std::array<std::size_t, kLevels> level_offset_{};
  std::vector<Texel> texels_;
};

}  // namespace rigmap
