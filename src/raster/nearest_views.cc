#include "raster/internal/nearest_views.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

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

NearestViews::Around NearestViews::NearTo(const Eigen::Vector2d& x_in_world) const {
  std::vector<Around::View> views;
  for (std::size_t i = 0; i < trajectory_.size(); ++i) {
    const Eigen::Vector3d& camera_in_world = trajectory_[i].world_from_left.translation;
    views.push_back({i, (camera_in_world.head<2>() - x_in_world).norm()});
  }
  std::ranges::stable_sort(views, {}, &Around::View::distance_m);
  return {x_in_world, std::move(views)};
}

std::optional<Eigen::Vector3d> NearestViews::Find(const Eigen::Vector3d& x_in_world,
                                                  const Around& around) const {
  std::optional<Eigen::Vector3d> nearest;
  double least_m = std::numeric_limits<double>::infinity();
  const double aside_m = (x_in_world.head<2>() - around.x_in_world).norm();
  for (const auto& [pose, from_around_m] : around.views) {
    if (from_around_m - aside_m >= least_m) break;  // and so are all that follow
    const Rigid3& world_from_left = trajectory_[pose].world_from_left;
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
  const auto around = views.NearTo(cells.InWorld(column + grid.columns / 2, row + grid.rows / 2));
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
        if (!asked) camera = views.Find(x_in_world, around);
        asked = true;
        CellQuality& quality = grid.quality[cell];
        quality.view_deg = camera ? AngleTo(x_in_world, *camera, quality.normal)
                                  : std::numeric_limits<float>::quiet_NaN();
      }
    }
  }
}

}  // namespace rigmap
