#include "tests/registration/relief.h"

#include <cmath>
#include <random>

namespace rigmap {

double ReliefAt(double x, double y, double relief_m) {
  return relief_m *
         (std::sin(4.0 * x + 1.0) * std::cos(3.0 * y) + 0.7 * std::sin(2.3 * x - 5.0 * y));
}

Rigid3 WorldFromLeft(double ahead_m, double turn_rad) {
  constexpr double kDown_rad = 0.7, kHeight_m = 1.2;
  Eigen::Matrix3d world_from_left;  // x right, y down, z forward seen along the world's x
  world_from_left << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const Eigen::Matrix3d tilted =
      Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix() * world_from_left *
      Eigen::AngleAxisd(-kDown_rad, Eigen::Vector3d::UnitX()).toRotationMatrix();
  return {Eigen::Quaterniond(tilted), {ahead_m, 0.0, kHeight_m}};
}

FrameCloud SeenFrom(const Rigid3& world_from_left, double relief_m, double noise_m, unsigned seed) {
  constexpr double kStep_m = 0.05, kSlope_m = 1e-4;
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, noise_m);
  std::uniform_real_distribution<double> shift(0.0, kStep_m);
  const Rigid3 left_from_world = world_from_left.Inverse();
  const double x_shift = shift(random), y_shift = shift(random);
  const Eigen::Vector3d forward = world_from_left.rotation * Eigen::Vector3d::UnitZ();
  const Eigen::Vector2d ahead = forward.head<2>().normalized(), side(-ahead.y(), ahead.x());
  FrameCloud cloud;
  for (double far_m = 0.8 + x_shift; far_m < 4.0; far_m += kStep_m) {
    for (double off_m = -0.5 * far_m + y_shift; off_m < 0.5 * far_m; off_m += kStep_m) {
      const Eigen::Vector2d at =
          world_from_left.translation.head<2>() + far_m * ahead + off_m * side;
      const double height_m = ReliefAt(at.x(), at.y(), relief_m);
      const Eigen::Vector3d normal(
          -(ReliefAt(at.x() + kSlope_m, at.y(), relief_m) - height_m) / kSlope_m,
          -(ReliefAt(at.x(), at.y() + kSlope_m, relief_m) - height_m) / kSlope_m, 1.0);
      Eigen::Vector3d x_in_left = left_from_world * Eigen::Vector3d(at.x(), at.y(), height_m);
      x_in_left += noise(random) * x_in_left.normalized();
      // Normals of planes through a dozen noisy points.
      Eigen::Vector3d noisy = normal.normalized();
      for (int axis = 0; axis < 2; ++axis) noisy[axis] += noise(random) / (2.0 * kStep_m);
      cloud.push_back({x_in_left.cast<float>(),
                       (left_from_world.rotation * noisy.normalized()).cast<float>(),
                       {100, 110, 120},
                       static_cast<float>(noise_m)});
    }
  }
  return cloud;
}

}  // namespace rigmap
