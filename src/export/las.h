// Point clouds as LAS 1.4 files (ASPRS, R15), the form that programs for laser scans read.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <functional>
#include <iosfwd>
#include <span>
#include <string>

#include "scene/point_cloud.h"

namespace rigmap {

// Where the coordinates of a file lie, and what it says of itself.
struct LasFrame {
  // x, y, z of the file from a point of the world, metres. Nothing: those of the world.
  std::function<Eigen::Vector3d(const Eigen::Vector3d&)> file_from_world = {};
  int epsg = 0;              // of a projected system in metres; 0: a local one, none is stated
  std::string warning = {};  // what readers have to know, a text area description; empty: nothing
};

// Writes a cloud piece by piece, 32 bytes per point: format 2 (coordinates in steps of 0.1 mm, red,
// green, blue of 16 bits) with the extra bytes `sigma` (float, metres) and `observations` (ushort).
// Intensity, classification and the like are 0, returns 1 of 1; no date. What tells the system are
// GeoTIFF keys. The points must be given twice, first all to Bound, then all to Write.
class LasWriter {
 public:
  // `stream` must outlive the writer.
  LasWriter(std::ostream& stream, LasFrame frame);

  void Bound(std::span<const SurfacePoint> points);
  // Throws DataError when the stream fails, as does Finish, and for a cloud wider than 400 km.
  void Write(std::span<const SurfacePoint> points);
  void Finish();

 private:
  Eigen::Vector3d InFile(const SurfacePoint& point) const;
  void WriteHead();

  std::ostream& stream_;
  LasFrame frame_;
  Eigen::AlignedBox3d bounds_;
  Eigen::Vector3d offset_ = Eigen::Vector3d::Zero();
  std::uint64_t bounded_ = 0, written_ = 0;
  bool has_head_ = false;
};

}  // namespace rigmap
