// Triangle meshes and what a surface is made of.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace rigmap {

// What a ray can meet. The first four are what a true surface is made of and its file calls `kind`.
enum class SurfaceKind : std::uint8_t {
  kSand = 0,        // the fine sand near the path
  kCoarseSand = 1,  // sand farther out
  kRock = 2,
  kDebris = 3,  // shells, pebbles, driftwood
  kDune = 4,
  kSea = 5,
  kMarker = 6,  // flat discs for checking the cameras
  kBody = 7,    // what moves: the rover, a person
};

// Vertices in metres; triangles index them counter-clockwise seen from outside.
struct Mesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  Eigen::Vector3f albedo = Eigen::Vector3f::Constant(0.5f);  // red, green, blue; linear, 0 to 1

  // Unit normals at the vertices: of the facets around them, weighted by area.
  std::vector<Eigen::Vector3f> VertexNormals() const;
  void Append(const Mesh& other);  // the albedo stays
};

// The unit sphere: 20 * 4^subdivisions triangles.
Mesh Icosphere(int subdivisions);

}  // namespace rigmap
