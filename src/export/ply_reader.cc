#include "export/ply_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

#include "core/error.h"
#include "export/ply.h"

namespace rigmap {
namespace {

template <class Integer>
Integer Clamped(double value) {
  return static_cast<Integer>(
      value > 0.0 ? std::min<double>(value, std::numeric_limits<Integer>::max()) : 0.0);
}

// Which of a file's properties belong to a surface point.
struct SurfaceProperties {
  std::array<const PlyProperty*, 3> x, normal, rgb;
  const PlyProperty* observations;
  const PlyProperty* sigma;
  const PlyProperty* grain;

  explicit SurfaceProperties(const PlyRows& rows)
      : x{rows.Find("x"), rows.Find("y"), rows.Find("z")},
        normal{rows.Find("nx"), rows.Find("ny"), rows.Find("nz")},
        rgb{rows.Find("red"), rows.Find("green"), rows.Find("blue")},
        observations(rows.Find("observations")),
        sigma(rows.Find("sigma")),
        grain(rows.Find("grain")) {
    if (!x[0] || !x[1] || !x[2]) {
      throw DataError(
          fmt::format("{}: expected vertices with x, y and z, found none", rows.name()));
    }
  }

  SurfacePoint Point(const char* row) const {
    SurfacePoint point;
    for (int i = 0; i < 3; ++i) {
      point.x_in_world(i) = static_cast<float>(PlyValue(*x[i], row));
      if (normal[i]) point.normal(i) = static_cast<float>(PlyValue(*normal[i], row));
      if (rgb[i]) point.rgb[i] = Clamped<std::uint8_t>(PlyValue(*rgb[i], row));
    }
    if (observations) {
      point.observations = Clamped<std::uint16_t>(PlyValue(*observations, row));
    }
    if (sigma) point.sigma_m = static_cast<float>(PlyValue(*sigma, row));
    if (grain) point.grain_m = static_cast<float>(PlyValue(*grain, row));
    return point;
  }
};

}  // namespace

PlyReader::PlyReader(const std::filesystem::path& path) : rows_(path) {
  static_cast<void>(SurfaceProperties(rows_));  // refuses one without x y z
}

bool PlyReader::Read(PointCloud& block) {
  const auto count = std::min<std::uint64_t>(kMaxPointsPerBlock, rows_.size() - points_read_);
  const SurfaceProperties properties(rows_);
  block.assign(count, {});
  for (SurfacePoint& point : block) point = properties.Point(rows_.Next());
  points_read_ += count;
  return count > 0;
}

PointCloud ReadPly(const std::filesystem::path& path) {
  PlyReader reader(path);
  PointCloud cloud, block;
  cloud.reserve(reader.point_count());
  while (reader.Read(block)) cloud.insert(cloud.end(), block.begin(), block.end());
  return cloud;
}

}  // namespace rigmap
