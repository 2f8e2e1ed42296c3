// A small cloud of which every map is known: flat ground of one colour with a box of another.
#pragma once

#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <vector>

#include "core/file.h"
#include "export/ply.h"

namespace rigmap {

constexpr std::array<std::uint8_t, 3> kSandRgb{200, 180, 140};
constexpr std::array<std::uint8_t, 3> kBoxRgb{40, 60, 160};

inline SurfacePoint MapPoint(double x_m, double y_m, double z_m,
                             const std::array<std::uint8_t, 3>& rgb = kSandRgb) {
  SurfacePoint point;
  point.x_in_world = Eigen::Vector3d(x_m, y_m, z_m).cast<float>();
  point.rgb = rgb;
  point.observations = 4;
  return point;
}

// The height of the ground, which rises with x and y: metres.
inline double GroundHeight(double x_m, double y_m) { return 0.1 * x_m + 0.05 * y_m - 1.0; }

// A point in the middle of each cell with x in [-1, 3) and y in [-0.5, 1.5); the box, 0.4 m high,
// covers [2, 2.4) x [1, 1.2). Cells for which `leave_out` is true have none.
inline PointCloud MapCloud(
    double cell_m,
    const std::function<bool(double, double)>& leave_out = [](double, double) { return false; }) {
  PointCloud cloud;
  for (long j = std::lround(-0.5 / cell_m); j < std::lround(1.5 / cell_m); ++j) {
    for (long i = std::lround(-1.0 / cell_m); i < std::lround(3.0 / cell_m); ++i) {
      const double x_m = (i + 0.5) * cell_m, y_m = (j + 0.5) * cell_m;
      if (leave_out(x_m, y_m)) continue;
      const bool box = x_m > 2.0 && x_m < 2.4 && y_m > 1.0 && y_m < 1.2;
      cloud.push_back(box ? MapPoint(x_m, y_m, GroundHeight(x_m, y_m) + 0.4, kBoxRgb)
                          : MapPoint(x_m, y_m, GroundHeight(x_m, y_m)));
    }
  }
  return cloud;
}

inline std::filesystem::path WriteCloud(const std::filesystem::path& path,
                                        const PointCloud& cloud) {
  WriteFileAtomically(path, [&](std::ostream& stream) {
    PlyWriter writer(stream);
    writer.Write(cloud);
    writer.Finish();
  });
  return path;
}

inline std::vector<std::string> NamesIn(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    names.push_back(entry.path().filename().string());
  }
  return names;
}

}  // namespace rigmap
