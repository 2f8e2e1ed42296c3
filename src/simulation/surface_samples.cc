#include "simulation/internal/surface_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace rigmap {
namespace {

constexpr double kPathStep_m = 0.1;  // the reach's edge waves by less than 0.4 mm
constexpr double kBoulderSpacing_m = 0.01, kDebrisSpacing_m = 0.003;
constexpr double kEdgeOfUnitArea = 1.5197;  // of the equilateral triangle
constexpr double kClearance_m = 1e-4;       // to start a ray beside a surface; floats hold 1e-5 m

std::vector<Eigen::Vector2d> Densified(std::span<const Eigen::Vector2d> path) {
  std::vector<Eigen::Vector2d> dense{path.front()};
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Eigen::Vector2d step = path[i] - path[i - 1];
    const int pieces = std::max(1, static_cast<int>(std::ceil(step.norm() / kPathStep_m)));
    for (int k = 1; k <= pieces; ++k) dense.push_back(path[i - 1] + step * k / pieces);
  }
  return dense;
}

// The whole multiples of a cell from which and up to which a row is near the path; merged, rising.
using Columns = std::vector<std::pair<int, int>>;

Columns ColumnsNear(std::span<const Eigen::Vector2d> path, double reach_m, double north_m,
                    double cell_m) {
  Columns reached;
  for (const Eigen::Vector2d& position : path) {
    const double north_off_m = north_m - position.y();
    const double half2 = reach_m * reach_m - north_off_m * north_off_m;
    if (half2 < 0.0) continue;
    const double half_m = std::sqrt(half2);
    reached.emplace_back(static_cast<int>(std::ceil((position.x() - half_m) / cell_m)),
                         static_cast<int>(std::floor((position.x() + half_m) / cell_m)));
  }
  std::sort(reached.begin(), reached.end());
  Columns merged;
  for (const auto& [first, last] : reached) {
    if (first > last) continue;
    if (merged.empty() || first > merged.back().second + 1) {
      merged.emplace_back(first, last);
    } else {
      merged.back().second = std::max(merged.back().second, last);
    }
  }
  return merged;
}

Eigen::AlignedBox3d BoxOf(const Mesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3f& vertex : mesh.vertices) box.extend(vertex.cast<double>());
  return box;
}

// The sand's mesh under a box.
class SandPatch {
 public:
  SandPatch(const World& world, const Eigen::AlignedBox3d& box)
      : cell_m_(world.options().sand_cell_m),
        first_column_(static_cast<int>(std::floor(box.min().x() / cell_m_))),
        first_row_(static_cast<int>(std::floor(box.min().y() / cell_m_))) {
    columns_ = static_cast<int>(std::floor(box.max().x() / cell_m_)) - first_column_ + 2;
    const int rows = static_cast<int>(std::floor(box.max().y() / cell_m_)) - first_row_ + 2;
    for (int i = 0; i < columns_ * rows; ++i) {
      heights_m_.push_back(world.terrain().Height((first_column_ + i % columns_) * cell_m_,
                                                  (first_row_ + i / columns_) * cell_m_, cell_m_));
    }
  }

  // A cell is two triangles; whichever way it is cut, the sand is not higher than this.
  double Top(const Eigen::Vector3d& position) const {
    const double x = position.x() / cell_m_ - first_column_,
                 y = position.y() / cell_m_ - first_row_;
    const int column = static_cast<int>(x), row = static_cast<int>(y);
    const double u = x - column, v = y - row;
    const double* south = heights_m_.data() + row * columns_ + column;
    const double* north = south + columns_;
    const double rising = u > v ? south[0] + u * (south[1] - south[0]) + v * (north[1] - south[1])
                                : south[0] + v * (north[0] - south[0]) + u * (north[1] - north[0]);
    const double falling =
        u + v < 1.0
            ? south[0] + u * (south[1] - south[0]) + v * (north[0] - south[0])
            : north[1] + (1.0 - u) * (north[0] - north[1]) + (1.0 - v) * (south[1] - north[1]);
    return std::max(rising, falling);
  }

 private:
  double cell_m_;
  int first_column_, first_row_, columns_ = 0;
  std::vector<double> heights_m_;
};

// Calls `take` on the centroids of equal triangles that make up this one, as large as a square of
// `spacing_m` or smaller.
template <class Take>
void ForCentroids(const std::array<Eigen::Vector3d, 3>& corner, double spacing_m, Take take) {
  const Eigen::Vector3d u = corner[1] - corner[0], v = corner[2] - corner[0];
  const double longest_m = std::max({u.norm(), v.norm(), (u - v).norm()});
  const int n = std::max(1, static_cast<int>(std::ceil(longest_m / (kEdgeOfUnitArea * spacing_m))));
  for (int i = 0; i < n; ++i) {
    for (int j = 0; i + j < n; ++j) {
      take(corner[0] + (u * (i + 1.0 / 3.0) + v * (j + 1.0 / 3.0)) / n);
      if (i + j + 1 < n) take(corner[0] + (u * (i + 2.0 / 3.0) + v * (j + 2.0 / 3.0)) / n);
    }
  }
}

}  // namespace

SurfaceSampler::SurfaceSampler(const World& world, std::span<const Eigen::Vector2d> path,
                               double reach_m)
    : world_(world), path_(Densified(path)), reach_m_(reach_m) {
  double south_m = std::numeric_limits<double>::max(), north_m = -south_m;
  for (const Eigen::Vector2d& position : path_) {
    south_m = std::min(south_m, position.y());
    north_m = std::max(north_m, position.y());
  }
  const double cell_m = world.options().sand_cell_m;
  first_row_ = static_cast<int>(std::ceil((south_m - reach_m_) / cell_m));
  row_count_ = static_cast<int>(std::floor((north_m + reach_m_) / cell_m)) - first_row_ + 1;
  for (const Boulder& boulder : world.boulders()) {
    boxes_of_boulders_.push_back(BoxOf(boulder.mesh));
  }
}

int SurfaceSampler::batch_count() const {
  return row_count_ + static_cast<int>(world_.boulders().size() + world_.debris().size());
}

std::vector<SurfaceSample> SurfaceSampler::Batch(int batch) const {
  if (batch < row_count_) return SandRow(first_row_ + batch);
  const auto boulder = static_cast<std::size_t>(batch - row_count_);
  if (boulder < world_.boulders().size()) {
    return Facets(world_.boulders()[boulder].mesh, SurfaceKind::kRock);
  }
  return Facets(world_.debris()[boulder - world_.boulders().size()], SurfaceKind::kDebris);
}

std::vector<SurfaceSample> SurfaceSampler::SandRow(int row) const {
  const double cell_m = world_.options().sand_cell_m;
  std::vector<SurfaceSample> samples;
  for (const auto& [first, last] : ColumnsNear(path_, reach_m_, row * cell_m, cell_m)) {
    for (int column = first; column <= last; ++column) {
      const SurfaceSample sample = SandNode(column, row);
      if (!IsInBoulder(sample.position + kClearance_m * Eigen::Vector3d::UnitZ())) {
        samples.push_back(sample);
      }
    }
  }
  return samples;
}

SurfaceSample SurfaceSampler::SandNode(int column, int row) const {
  const double cell_m = world_.options().sand_cell_m;
  const auto height_m = [&](int i, int j) {
    return world_.terrain().Height(i * cell_m, j * cell_m, cell_m);
  };
  const double rise_east_m = height_m(column + 1, row) - height_m(column - 1, row);
  const double rise_north_m = height_m(column, row + 1) - height_m(column, row - 1);
  return {{column * cell_m, row * cell_m, height_m(column, row)},
          Eigen::Vector3d(-rise_east_m, -rise_north_m, 2.0 * cell_m).normalized(),
          SurfaceKind::kSand};
}

std::vector<SurfaceSample> SurfaceSampler::Facets(const Mesh& mesh, SurfaceKind kind) const {
  const double spacing_m = kind == SurfaceKind::kRock ? kBoulderSpacing_m : kDebrisSpacing_m;
  const SandPatch sand(world_, BoxOf(mesh));
  std::vector<SurfaceSample> samples;
  for (const auto& triangle : mesh.triangles) {
    std::array<Eigen::Vector3d, 3> corner;
    for (std::size_t i = 0; i < 3; ++i) corner[i] = mesh.vertices[triangle[i]].cast<double>();
    const Eigen::Vector3d twice_area = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
    if (!(twice_area.norm() > 0.0)) continue;
    const Eigen::Vector3d normal = twice_area.normalized();
    ForCentroids(corner, spacing_m, [&](const Eigen::Vector3d& position) {
      if (position.z() > sand.Top(position) && IsNearPath(position.head<2>()) &&
          !IsInBoulder(position + kClearance_m * normal)) {
        samples.push_back({position, normal, kind});
      }
    });
  }
  return samples;
}

bool SurfaceSampler::IsNearPath(const Eigen::Vector2d& position) const {
  return std::any_of(path_.begin(), path_.end(), [&](const Eigen::Vector2d& near) {
    return (near - position).squaredNorm() <= reach_m_ * reach_m_;
  });
}

// Boulders are closed and apart from each other: a ray out of one crosses them an odd number of
// times.
bool SurfaceSampler::IsInBoulder(const Eigen::Vector3d& position) const {
  const auto in_box = [&](const Eigen::AlignedBox3d& box) { return box.contains(position); };
  if (std::none_of(boxes_of_boulders_.begin(), boxes_of_boulders_.end(), in_box)) return false;
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  bool inside = false;
  Eigen::Vector3d origin = position;
  while (const auto hit = world_.Cast(origin, up)) {
    if (hit->kind == SurfaceKind::kRock) inside = !inside;
    origin = hit->position + kClearance_m * up;
  }
  return inside;
}

}  // namespace rigmap
