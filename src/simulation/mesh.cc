#include "simulation/mesh.h"

#include <Eigen/Geometry>
#include <map>

namespace rigmap {
namespace {

Mesh Icosahedron() {
  const float a = 0.525731112f, b = 0.850650808f;
  Mesh mesh;
  mesh.vertices = {{-a, b, 0},  {a, b, 0},  {-a, -b, 0}, {a, -b, 0}, {0, -a, b},  {0, a, b},
                   {0, -a, -b}, {0, a, -b}, {b, 0, -a},  {b, 0, a},  {-b, 0, -a}, {-b, 0, a}};
  mesh.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                    {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                    {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                    {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  return mesh;
}

Mesh Subdivide(const Mesh& coarse) {
  Mesh fine;
  fine.vertices = coarse.vertices;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto [position, is_new] = middles.try_emplace(std::minmax(a, b), fine.vertices.size());
    if (is_new) fine.vertices.push_back((fine.vertices[a] + fine.vertices[b]).normalized());
    return position->second;
  };
  for (const auto& [a, b, c] : coarse.triangles) {
    const auto ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    fine.triangles.insert(fine.triangles.end(),
                          {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
  }
  return fine;
}

}  // namespace

std::vector<Eigen::Vector3f> Mesh::VertexNormals() const {
  std::vector<Eigen::Vector3f> normals(vertices.size(), Eigen::Vector3f::Zero());
  for (const auto& [a, b, c] : triangles) {
    const Eigen::Vector3f facet = (vertices[b] - vertices[a]).cross(vertices[c] - vertices[a]);
    for (const auto i : {a, b, c}) normals[i] += facet;
  }
  for (auto& normal : normals) normal.normalize();
  return normals;
}

void Mesh::Append(const Mesh& other) {
  const auto first = static_cast<std::uint32_t>(vertices.size());
  vertices.insert(vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& [a, b, c] : other.triangles) {
    triangles.push_back({a + first, b + first, c + first});
  }
}

Mesh Icosphere(int subdivisions) {
  Mesh mesh = Icosahedron();
  for (int i = 0; i < subdivisions; ++i) mesh = Subdivide(mesh);
  return mesh;
}

}  // namespace rigmap
