// Embree behind a few functions: meshes and height grids in, first hits out.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "simulation/mesh.h"

namespace rigmap {

// Directions need not be of unit length; distances count in their lengths. Single precision: a hit
// 100 m from the origin is good to about 10 micrometres.
struct Ray {
  Eigen::Vector3f origin, direction;
  float first = 0.0f, last = std::numeric_limits<float>::infinity();  // distances
};

struct RayHit {
  float distance = 0.0f;
  Eigen::Vector3f normal;                 // of the facet, not of unit length
  std::uint32_t geometry = 0, facet = 0;  // what Add... returned; triangle, or grid, in it
  float u = 0.0f, v = 0.0f;               // barycentric weights of the second and third corner
};

// A rectangle of columns x rows vertices that starts at vertex `first`.
struct VertexGrid {
  std::uint32_t first = 0;
  std::uint16_t columns = 0, rows = 0;
};

// Filled, committed, then asked from any number of threads. The same additions give the same
// answers on any machine of one kind: the tree is built by one thread.
class RayScene {
 public:
  RayScene();
  ~RayScene();
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;

  std::uint32_t AddMesh(const Mesh& mesh);
  // Each cell of a grid is two triangles.
  std::uint32_t AddGrids(const std::vector<Eigen::Vector3f>& vertices,
                         const std::vector<VertexGrid>& grids);
  void Commit();

  std::optional<RayHit> Cast(const Ray& ray) const;
  // Eight rays from one place in directions that differ little: twice as fast as one by one.
  using Directions = std::array<Eigen::Vector3f, 8>;
  std::array<std::optional<RayHit>, 8> Cast(const Eigen::Vector3f& origin,
                                            const Directions& directions) const;
  bool IsOccluded(const Ray& ray) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rigmap
