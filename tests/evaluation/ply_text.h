// PLY files made by tests.
#pragma once

#include <fmt/format.h>

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "evaluation/map_truth.h"

namespace rigmap {

inline std::string PlyHead(std::size_t count, const std::string& properties) {
  return fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\n{}end_header\n",
                     count, properties);
}

template <class Scalar>
void AppendBytes(std::string& bytes, Scalar value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

inline std::string MapPly(const std::vector<Eigen::Vector3f>& points) {
  std::string bytes =
      PlyHead(points.size(), "property float x\nproperty float y\nproperty float z\n");
  for (const auto& point : points) {
    for (int i = 0; i < 3; ++i) AppendBytes(bytes, point(i));
  }
  return bytes;
}

// As the simulator writes it; without the last `left_out` of its properties.
inline std::string SurfacePly(const TrueSurface& surface, int left_out = 0) {
  std::string properties =
      "property float x\nproperty float y\nproperty float z\n"
      "property char nx\nproperty char ny\nproperty char nz\n";
  if (left_out < 2) properties += "property uchar visible\n";
  if (left_out < 1) properties += "property uchar kind\n";
  std::string bytes = PlyHead(surface.size(), properties);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    for (int k = 0; k < 3; ++k) AppendBytes(bytes, surface.x_in_truth[i](k));
    for (int k = 0; k < 3; ++k) {
      AppendBytes(bytes, static_cast<std::int8_t>(std::lround(127.0F * surface.normal[i](k))));
    }
    if (left_out < 2) AppendBytes(bytes, surface.visible[i]);
    if (left_out < 1) AppendBytes(bytes, surface.kind[i]);
  }
  return bytes;
}

}  // namespace rigmap
