#include "raster/internal/nearest_views.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace rigmap {
namespace {

constexpr int kBlock = 4;  // cells that share a camera

float AngleTo(const Eigen::Vector3d& x_in_world, const Eigen::Vector3d& camera_in_world,
              const std::array<float, 3>& normal_sum) {
  Eigen::Vector3d normal(normal_sum[0], normal_sum[1], normal_sum[2]);
  if (!(normal.norm() > 0.0)) normal = Eigen::Vector3d::UnitZ();
  const double cosine = normal.normalized().dot((camera_in_world - x_in_world).normalized());
  return static_cast<float>(std::acos(std::clamp(cosine, -1.0, 1.0)) * 180.0 / std::numbers::pi);
}

}  // namespace

std::vector<std::size_t> NearestViews::NearTo(const Eigen::Vector2d& x_in_world) const {
  std::vector<std::size_t> order(trajectory_.size());
  std::iota(order.begin(), order.end(), 0);
  const auto distance_m = [&](std::size_t i) {
    return (trajectory_[i].world_from_left.translation.head<2>() - x_in_world).norm();
  };
  std::ranges::stable_sort(order, {}, distance_m);
  constexpr std::size_t kMostViews = 400;  // a hundred metres of path, at the least
  if (order.size() > kMostViews) order.resize(kMostViews);
  return order;
}

std::optional<Eigen::Vector3d> NearestViews::Find(const Eigen::Vector3d& x_in_world,
                                                  const std::vector<std::size_t>& nearby) const {
  std::optional<Eigen::Vector3d> nearest;
  double least_m = std::numeric_limits<double>::infinity();
  for (const std::size_t i : nearby) {
    const Rigid3& world_from_left = trajectory_[i].world_from_left;
    const double distance_m = (x_in_world - world_from_left.translation).norm();
    if (distance_m >= least_m) continue;
    const auto pixel = Project(camera_, world_from_left.Inverse() * x_in_world);
    if (!pixel || !camera_.Contains(*pixel)) continue;
    least_m = distance_m;
    nearest = world_from_left.translation;
  }
  return nearest;
}

void AddViewAngles(const NearestViews& views, const PointCells& cells, int column, int row,
                   SurfaceGrid& grid) {
  const auto nearby = views.NearTo(cells.InWorld(column + grid.columns / 2, row + grid.rows / 2));
  for (int r = 0; r < grid.rows; r += kBlock) {
    for (int c = 0; c < grid.columns; c += kBlock) {
      std::optional<Eigen::Vector3d> camera;
      bool asked = false;
      for (int i = 0; i < kBlock * kBlock; ++i) {
        const int x = c + i % kBlock, y = r + i / kBlock;
        if (!grid.Holds(x, y)) continue;
        Eigen::Vector3d x_in_world;
        const std::size_t cell = grid.Index(x, y);
        x_in_world << cells.InWorld(column + x, row + y), grid.height_m[cell];
        if (!asked) camera = views.Find(x_in_world, nearby);
        asked = true;
        CellQuality& quality = grid.quality[cell];
        quality.view_deg = camera ? AngleTo(x_in_world, *camera, quality.normal)
                                  : std::numeric_limits<float>::quiet_NaN();
      }
    }
  }
}

}  // namespace rigmap
