// What a World is made of, for those who build and draw it.
#pragma once

#include <memory>
#include <vector>

#include "simulation/world.h"

namespace rigmap {

// A mesh with light and colour at its vertices.
struct LitMesh {
  Mesh mesh;
  std::vector<Eigen::Vector3f> albedo;
  std::vector<std::uint32_t> piece;  // which of the merged meshes each vertex is of
  std::vector<Light> light;
  SurfaceKind kind = SurfaceKind::kRock;
  std::uint32_t geometry = 0;  // in the scene
};

struct World::Parts {
  SceneOptions options;
  Terrain terrain;
  std::vector<Boulder> boulders;
  std::vector<Mesh> debris;
  std::vector<Eigen::Vector3d> markers;
  SandTiles tiles;
  RayScene scene;
  std::uint32_t sand_geometry = 0;
  std::vector<LitMesh> solids;  // boulders, debris, markers, sea
  std::unique_ptr<SandStates> sand;
  std::uint32_t material_seed = 0;  // of the materials

  const LitMesh* SolidOf(std::uint32_t geometry) const;
  SurfaceKind KindOf(const RayHit& hit) const;
};

}  // namespace rigmap
