#include "matching/ground_warp.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace rigmap {
namespace {

// Enough to average out the noise of depths, few enough to stay on one side of a pebble.
constexpr std::size_t kPlanePoints = 16;
// Cosine between line of sight and normal under which a plane counts as seen edge-on.
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

// Unit normal of the plane that fits best.
Eigen::Vector3d PlaneNormal(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& x : points) mean += x / static_cast<double>(points.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const auto& x : points) scatter += (x - mean) * (x - mean).transpose();
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors().col(0);
}

}  // namespace

std::optional<Eigen::Matrix2d> GroundWarp(const std::vector<Feature>& features,
                                          const std::vector<std::optional<StereoPoint>>& points,
                                          int index, const Rigid3& b_from_a, const Camera& camera) {
  const std::vector<Eigen::Vector3d> nearest = NearestPoints(features, points, index);
  if (nearest.size() < kPlanePoints / 2) return std::nullopt;
  const Eigen::Vector3d normal = PlaneNormal(nearest);
  const Eigen::Vector3d& x = points[index]->x_in_left;
  const Eigen::Vector3d eye_of_b = b_from_a.Inverse().translation;
  const double side_a = normal.dot(x) / x.norm();
  const double side_b = normal.dot(x - eye_of_b) / (x - eye_of_b).norm();
  if (std::abs(side_a) < kEdgeOn || side_b * (side_a > 0.0 ? 1.0 : -1.0) < kEdgeOn) {
    return std::nullopt;
  }
  const auto in_b = [&](const Eigen::Vector2d& pixel) -> std::optional<Eigen::Vector2d> {
    const auto ray = Undistort(camera, pixel);
    if (!ray) return std::nullopt;
    const Eigen::Vector3d direction = ray->homogeneous();
    const double along = normal.dot(direction);
    if (std::abs(along) < 1e-9) return std::nullopt;
    return Project(camera, b_from_a * (normal.dot(x) / along * direction));
  };
  Eigen::Matrix2d warp;
  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::Vector2d step = Eigen::Vector2d::Unit(axis);
    const auto before = in_b(features[index].left - step),
               after = in_b(features[index].left + step);
    if (!before || !after) return std::nullopt;
    warp.col(axis) = 0.5 * (*after - *before);
  }
  return warp;
}

}  // namespace rigmap
