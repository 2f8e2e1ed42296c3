#include "evaluation/internal/rock_view.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rigmap {
namespace {

constexpr double kMaxViewRange_m = 6.5;  // of stereo that is good enough for a map
constexpr double kLeastCosine = 0.77;    // of 40 degrees, half the field of view
constexpr double kLeastDepth_m = 0.5;    // nearer poses do not see more

double InverseFourthPower(double value) { return std::pow(value, -4.0); }

// 0 where the pose does not see the middle.
double WeightOfView(const Rigid3& world_from_camera, const Eigen::Vector3d& middle) {
  const double range_m = (middle - world_from_camera.translation).norm();
  const double depth_m = (world_from_camera.Inverse() * middle).z();
  if (!(range_m < kMaxViewRange_m) || !(depth_m > kLeastCosine * range_m)) return 0.0;
  return InverseFourthPower(std::max(depth_m, kLeastDepth_m));
}

}  // namespace

Eigen::Matrix3d ViewAxes(std::span<const Eigen::Vector3d> points, std::span<const TumPose> poses) {
  const Eigen::Vector3d sum =
      std::accumulate(points.begin(), points.end(), Eigen::Vector3d(Eigen::Vector3d::Zero()));
  const Eigen::Vector3d middle = sum / static_cast<double>(points.size());
  Eigen::Vector2d seeing = Eigen::Vector2d::Zero(), any = Eigen::Vector2d::Zero();
  for (const TumPose& pose : poses) {
    const Eigen::Vector3d ray = middle - pose.world_from_body.translation;
    const Eigen::Vector2d direction = ray.head<2>().normalized();
    seeing += WeightOfView(pose.world_from_body, middle) * direction;
    any += InverseFourthPower(ray.norm()) * direction;
  }
  const Eigen::Vector2d view = (seeing.isZero(0.0) ? any : seeing).normalized();
  Eigen::Matrix3d axes;
  axes << view.x(), view.y(), 0.0, -view.y(), view.x(), 0.0, 0.0, 0.0, 1.0;
  return axes;
}

}  // namespace rigmap
