#include "tests/fusion/seen_ground.h"

#include <cmath>
#include <numbers>

namespace rigmap {
namespace {

constexpr double kHeightM = 1.1;
constexpr double kFarthestM = 4.0;

// Along a ray that is 1 long in the z of rectified axes; infinity where nothing is hit.
double DepthAlong(const Eigen::Vector3d& centre, const Eigen::Vector3d& ray,
                  const std::optional<Plate>& plate) {
  if (ray.z() >= 0.0) return INFINITY;
  if (plate) {
    const double depth_m = (plate->height_m - centre.z()) / ray.z();
    const Eigen::Array2d hit = (centre + depth_m * ray).head<2>();
    if ((hit >= plate->least.array()).all() && (hit <= plate->most.array()).all()) return depth_m;
  }
  return -centre.z() / ray.z();
}

}  // namespace

Rigid3 WorldFromLeft(double x_m) {
  Eigen::Matrix3d level;  // columns: right, down, forward
  level << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const Eigen::AngleAxisd down(-std::numbers::pi / 6.0, Eigen::Vector3d::UnitX());
  return {Eigen::Quaterniond(level) * down, {x_m, 0.3 * std::sin(x_m), kHeightM}};
}

DepthMap GroundSeenFrom(const Rigid3& world_from_left, const GroundView& view,
                        SeededRandom& random) {
  DepthMap map;
  map.camera = {320, 240, 260.0, 260.0, 160.0, 120.0};
  map.left_from_rectified.rotation = ExpRotation({0.01, -0.02, 0.005});
  map.baseline_m = 0.12;
  map.disparity = cv::Mat(240, 320, CV_32FC1, cv::Scalar(0.0));
  map.disparity_sigma = cv::Mat(240, 320, CV_32FC1, cv::Scalar(view.sigma_px));
  map.colour = cv::Mat(240, 320, CV_8UC3, cv::Scalar(30, 20, 10));
  const Rigid3 world_from_rectified = world_from_left * map.left_from_rectified;
  const double disparity_at_1_m = map.camera.fx * map.baseline_m;
  for (int row = 0; row < 240; ++row) {
    for (int column = 0; column < 320; ++column) {
      const Eigen::Vector3d ray =
          world_from_rectified.rotation * map.PointInRectified(column, row, disparity_at_1_m);
      const double depth_m = DepthAlong(world_from_rectified.translation, ray, view.plate);
      if (depth_m > kFarthestM) continue;
      map.disparity.at<float>(row, column) =
          static_cast<float>(disparity_at_1_m / depth_m + random.Normal(view.noise_px));
    }
  }
  return map;
}

}  // namespace rigmap
