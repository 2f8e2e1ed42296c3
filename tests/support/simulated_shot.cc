#include "tests/support/simulated_shot.h"

#include <Eigen/Geometry>
#include <array>
#include <opencv2/imgproc.hpp>

#include "simulation/camera_response.h"
#include "simulation/view_renderer.h"

namespace rigmap {
namespace {

// Nothing that hides sand from one eye; the mesh is coarse, to be built quickly.
SceneOptions OpenSand(std::uint64_t seed) {
  SceneOptions scene = MakeScene("beach", seed);
  scene.boulders_per_100_m2 = scene.debris_per_m2 = 0.0;
  scene.contrast = 1.5;
  scene.sand_cell_m = 0.04;
  return scene;
}

// Above the origin, looking north.
Rigid3 WorldFromSlantedCamera() {
  constexpr double kHeight_m = 1.5, kAboveHorizontal_rad = -1.05, kRoll_rad = 0.2;
  Eigen::Matrix3d level;
  level.col(0) = Eigen::Vector3d::UnitX();
  level.col(1) = -Eigen::Vector3d::UnitZ();
  level.col(2) = Eigen::Vector3d::UnitY();
  return {Eigen::Quaterniond(level) *
              Eigen::AngleAxisd(kAboveHorizontal_rad, Eigen::Vector3d::UnitX()) *
              Eigen::AngleAxisd(kRoll_rad, Eigen::Vector3d::UnitZ()),
          {0.0, 0.0, kHeight_m}};
}

cv::Mat Take(const World& world, const Camera& camera, const Rigid3& world_from_camera) {
  const CameraResponse response{.read_noise = 0.0, .shot_noise = 0.0};
  cv::Mat grey;
  cv::cvtColor(TakePicture(ViewRenderer(world, camera).Render(world_from_camera), response, {}),
               grey, cv::COLOR_BGR2GRAY);
  return grey;
}

}  // namespace

SimulatedShot::SimulatedShot(const StereoRig& rig, std::uint64_t seed)
    : camera_(rig.left.camera),
      world_(OpenSand(seed), std::array{Eigen::Vector2d(0.0, 0.0)}),
      world_from_left_(WorldFromSlantedCamera()),
      left_(Take(world_, camera_, world_from_left_)),
      right_(Take(world_, rig.right.camera, world_from_left_ * rig.right_from_left.Inverse())) {}

std::optional<Eigen::Vector3d> SimulatedShot::HitAlong(const Eigen::Vector3d& ray_in_left) const {
  const Eigen::Vector3d direction = ray_in_left.normalized();
  const auto hit = world_.Cast(world_from_left_.translation, world_from_left_.rotation * direction);
  if (!hit) return std::nullopt;
  return Eigen::Vector3d(hit->distance_m * direction);
}

std::optional<Eigen::Vector3d> SimulatedShot::HitAt(const Eigen::Vector2d& left_pixel) const {
  const auto normalised = Undistort(camera_, left_pixel);
  if (!normalised) return std::nullopt;
  return HitAlong(normalised->homogeneous());
}

}  // namespace rigmap
