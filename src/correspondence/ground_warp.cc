#include "correspondence/ground_warp.h"

#include <algorithm>
#include <cmath>

#include "geometry/plane_fit.h"

namespace rigmap {
namespace {

// Enough to average out the noise of depths, few enough to stay on one side of a pebble.
constexpr std::size_t kPlanePoints = 16;
// Cosine between line of sight and normal under which a plane counts as seen edge-on: ground that
// is not quite flat need not look like a plane there.
constexpr double kEdgeOn = 0.1;

std::vector<Eigen::Vector3d> NearestPoints(const std::vector<Feature>& features,
                                           const std::vector<std::optional<StereoPoint>>& points,
                                           int index) {
  std::vector<std::pair<double, int>> by_distance;
  for (std::size_t i = 0; i < features.size(); ++i) {
    if (!points[i]) continue;
    by_distance.emplace_back((features[i].left - features[index].left).squaredNorm(),
                             static_cast<int>(i));
  }
  const std::size_t count = std::min(kPlanePoints, by_distance.size());
  std::partial_sort(by_distance.begin(), by_distance.begin() + static_cast<std::ptrdiff_t>(count),
                    by_distance.end());
  std::vector<Eigen::Vector3d> nearest;
  for (std::size_t i = 0; i < count; ++i) {
    nearest.push_back(points[by_distance[i].second]->x_in_left);
  }
  return nearest;
}

}  // namespace

std::optional<GroundPatch> GroundAround(const std::vector<Feature>& features,
                                        const std::vector<std::optional<StereoPoint>>& points,
                                        int index, int frame) {
  const std::vector<Eigen::Vector3d> nearest = NearestPoints(features, points, index);
  if (nearest.size() < kPlanePoints / 2) return std::nullopt;
  // 1/z over x/z and y/z: disparities are as good near as far, so that this plane is, whereas one
  // through points that are scattered along their rays turns towards the eye.
  PlaneFit nearness;
  for (const Eigen::Vector3d& x : nearest) {
    nearness.Add(x.x() / x.z(), x.y() / x.z(), 1.0 / x.z());
  }
  const Eigen::Vector3d normal = nearness.Solve().normalized();
  if (!normal.allFinite()) return std::nullopt;
  return GroundPatch{frame, features[index].left.array().round(), points[index]->x_in_left, normal};
}

Eigen::Array2d DepthChange(const GroundPatch& patch, const Camera& camera) {
  // Inverse depth where the pixel's ray meets the plane, but for a factor.
  const auto nearness = [&](const Eigen::Vector2d& pixel) {
    const auto ray = Undistort(camera, pixel);
    return ray ? patch.normal.dot(ray->homogeneous()) : NAN;
  };
  const double here = nearness(patch.centre);
  Eigen::Array2d change;
  for (int axis = 0; axis < 2; ++axis) {
    const double next = nearness(patch.centre + Eigen::Vector2d::Unit(axis));
    change(axis) = std::abs(next / here - 1.0);
  }
  return change.isFinite().select(change, 0.0);
}

std::optional<PatchWarp> GroundWarp(const GroundPatch& patch, const Rigid3& b_from_a,
                                    const Camera& camera) {
  const Eigen::Vector3d &x = patch.x, &normal = patch.normal;
  const Eigen::Vector3d eye_of_b = b_from_a.Inverse().translation;
  const double side_a = normal.dot(x) / x.norm();
  const double side_b = normal.dot(x - eye_of_b) / (x - eye_of_b).norm();
  if (std::abs(side_a) < kEdgeOn || side_b * (side_a > 0.0 ? 1.0 : -1.0) < kEdgeOn) {
    return std::nullopt;
  }
  const auto in_b = [&](const Eigen::Vector2d& offset) -> Eigen::Vector2d {
    const auto ray = Undistort(camera, patch.centre + offset);
    if (!ray) return Eigen::Vector2d::Constant(NAN);
    const Eigen::Vector3d direction = ray->homogeneous();
    const auto pixel =
        Project(camera, b_from_a * (normal.dot(x) / normal.dot(direction) * direction));
    return pixel.value_or(Eigen::Vector2d::Constant(NAN));
  };
  return WarpOf(in_b);
}

}  // namespace rigmap
