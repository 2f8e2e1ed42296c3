#include "report/map_views.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/statistics.h"

namespace rigmap {
namespace {

constexpr int kCellsAlong = 96;
constexpr double kUsualShare = 0.95, kFarShare = 0.01;

struct Middle {
  Eigen::Vector3d x = Eigen::Vector3d::Zero();
  int points = 0;
};

// Depths at which images show the point, in no order.
std::vector<double> DepthsOf(const Eigen::Vector3d& x, const Camera& left,
                             const std::vector<Rigid3>& left_from_world) {
  std::vector<double> depths;
  for (const Rigid3& pose : left_from_world) {
    const Eigen::Vector3d seen = pose * x;
    const auto pixel = Project(left, seen);
    if (pixel && left.Contains(*pixel)) depths.push_back(seen.z());
  }
  return depths;
}

class CellGrid {
 public:
  explicit CellGrid(const PointCloud& points) {
    Eigen::Vector2d low, high;
    for (const int axis : {0, 1}) {
      std::vector<float> values;
      for (const SurfacePoint& point : points) values.push_back(point.x_in_world[axis]);
      low[axis] = Quantile(values, kFarShare);
      high[axis] = Quantile(std::move(values), 1.0 - kFarShare);
    }
    views_.low_m = low;
    views_.cell_m = std::max((high - low).maxCoeff() / kCellsAlong, 1e-3);
    views_.columns = CellsIn(high.x() - low.x());
    views_.rows = CellsIn(high.y() - low.y());
    middles_.resize(static_cast<std::size_t>(views_.columns) *
                    static_cast<std::size_t>(views_.rows));
    for (const SurfacePoint& point : points) Add(point.x_in_world.cast<double>());
  }

  std::optional<MapViews> SeenFrom(const std::vector<Rigid3>& left_from_world,
                                   const Camera& left) && {
    std::vector<std::vector<double>> depths(middles_.size());
    oneapi::tbb::parallel_for(std::size_t{0}, middles_.size(), [&](std::size_t i) {
      if (middles_[i].points > 0) depths[i] = DepthsOf(middles_[i].x, left, left_from_world);
    });
    std::vector<double> nearest;
    for (const auto& cell : depths) {
      if (!cell.empty()) nearest.push_back(*std::ranges::min_element(cell));
    }
    if (nearest.empty()) return std::nullopt;
    const double usual = Quantile(nearest, kUsualShare);
    for (const Middle& middle : middles_) {
      views_.heights_m.push_back(middle.points > 0 ? middle.x.z()
                                                   : std::numeric_limits<double>::quiet_NaN());
    }
    std::vector<double> counts;
    for (const auto& cell : depths) {
      int images = 0;
      if (!cell.empty()) {
        const double farthest = std::max(usual, *std::ranges::min_element(cell));
        images = static_cast<int>(
            std::ranges::count_if(cell, [&](double depth) { return depth <= farthest; }));
        counts.push_back(images);
      }
      views_.images.push_back(images);
    }
    views_.median_images = Median(counts);
    views_.usual_most_images = static_cast<int>(Quantile(counts, kUsualShare));
    views_.median_pixel_m = Median(nearest) / left.MeanFocal();
    return std::move(views_);
  }

 private:
  int CellsIn(double length_m) const {
    return std::max(1, static_cast<int>(std::ceil(length_m / views_.cell_m)));
  }

  void Add(const Eigen::Vector3d& x) {
    const Eigen::Vector2d at = (x.head<2>() - views_.low_m) / views_.cell_m;
    const int column = static_cast<int>(std::floor(at.x()));
    const int row = static_cast<int>(std::floor(at.y()));
    if (column < 0 || row < 0 || column >= views_.columns || row >= views_.rows) return;
    Middle& middle = middles_[static_cast<std::size_t>(row * views_.columns + column)];
    middle.x += (x - middle.x) / ++middle.points;
  }

  MapViews views_;
  std::vector<Middle> middles_;
};

}  // namespace

std::optional<MapViews> ViewsOf(const PointCloud& points, const Camera& left,
                                const Trajectory& trajectory) {
  std::vector<Rigid3> left_from_world;
  for (const TimedPose& pose : trajectory) {
    if (pose.source == PoseSource::kPredicted) continue;
    left_from_world.push_back(pose.world_from_left.Inverse());
  }
  if (points.empty() || left_from_world.empty()) return std::nullopt;
  return CellGrid(points).SeenFrom(left_from_world, left);
}

}  // namespace rigmap
