#include "export/ply_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <limits>
#include <string>

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

  SurfaceProperties(const PlyHeader& header, const std::string& file)
      : x{header.Find("x"), header.Find("y"), header.Find("z")},
        normal{header.Find("nx"), header.Find("ny"), header.Find("nz")},
        rgb{header.Find("red"), header.Find("green"), header.Find("blue")},
        observations(header.Find("observations")),
        sigma(header.Find("sigma")) {
    if (!x[0] || !x[1] || !x[2]) {
      throw DataError(fmt::format("{}: expected vertices with x, y and z, found none", file));
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
    return point;
  }
};

}  // namespace

PlyReader::PlyReader(const std::filesystem::path& path)
    : path_(path), stream_(path, std::ios::binary) {
  if (!stream_ || std::filesystem::is_directory(path)) {
    throw DataError(fmt::format("{}: cannot read: {}", path.string(), std::strerror(errno)));
  }
  header_ = ReadPlyHeader(stream_, path.string());
  static_cast<void>(SurfaceProperties(header_, path.string()));  // refuses one without x y z
  const auto bytes_left = std::filesystem::file_size(path) - stream_.tellg();
  if (bytes_left / header_.row_bytes < header_.vertex_count) {
    throw DataError(fmt::format("{}: expected {} vertices of {} bytes, found {} bytes",
                                path.string(), header_.vertex_count, header_.row_bytes,
                                bytes_left));
  }
}

bool PlyReader::Read(PointCloud& block) {
  const auto count =
      std::min<std::uint64_t>(kMaxPointsPerBlock, header_.vertex_count - points_read_);
  block.assign(count, {});
  rows_.resize(count * header_.row_bytes);
  stream_.read(rows_.data(), static_cast<std::streamsize>(rows_.size()));
  if (!stream_) throw DataError(fmt::format("{}: cannot read its vertices", path_.string()));
  const SurfaceProperties properties(header_, path_.string());
  const char* row = rows_.data();
  for (SurfacePoint& point : block) {
    point = properties.Point(row);
    row += header_.row_bytes;
  }
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
