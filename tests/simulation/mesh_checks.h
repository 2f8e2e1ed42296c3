// What a closed surface must fulfil.
#pragma once

#include <Eigen/Geometry>
#include <map>
#include <utility>

#include "simulation/mesh.h"

namespace rigmap {

// True if each edge belongs to two triangles, which run along it in opposite directions.
inline bool IsClosed(const Mesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> runs;
  for (const auto& triangle : mesh.triangles) {
    for (int i = 0; i < 3; ++i) ++runs[{triangle[i], triangle[(i + 1) % 3]}];
  }
  for (const auto& [edge, count] : runs) {
    const auto opposite = runs.find({edge.second, edge.first});
    if (count != 1 || opposite == runs.end()) return false;
  }
  return !mesh.triangles.empty();
}

// Cubic metres; positive for a closed mesh whose triangles face outwards.
inline double VolumeOf(const Mesh& mesh) {
  double volume_m3 = 0.0;
  const Eigen::Vector3d origin = mesh.vertices.front().cast<double>();
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto at = [&](std::uint32_t i) { return (mesh.vertices[i].cast<double>() - origin); };
    volume_m3 += at(a).dot(at(b).cross(at(c))) / 6.0;
  }
  return volume_m3;
}

}  // namespace rigmap
