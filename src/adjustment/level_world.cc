#include "adjustment/level_world.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include "core/statistics.h"

namespace rigmap {
namespace {

using Poses = std::vector<std::optional<Rigid3>>;

const Rigid3& FirstPose(const Poses& gauge_from_left) {
  return **std::find_if(gauge_from_left.begin(), gauge_from_left.end(),
                        [](const auto& motion) { return motion.has_value(); });
}

std::optional<Eigen::Vector3d> UpFromImu(const Poses& gauge_from_left, const Dataset& dataset) {
  if (!dataset.rig.imu_from_left || dataset.inclinometer.empty()) return std::nullopt;
  const Eigen::Quaterniond left_from_imu = dataset.rig.imu_from_left->rotation.conjugate();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const InclinometerSample& sample : dataset.inclinometer) {
    const auto frame = std::lower_bound(
        dataset.frames.begin(), dataset.frames.end(), sample.stamp_ns,
        [](const StereoFrame& f, StampNs stamp_ns) { return f.stamp_ns < stamp_ns; });
    if (frame == dataset.frames.end() || frame->stamp_ns != sample.stamp_ns) continue;
    const auto& motion = gauge_from_left[static_cast<std::size_t>(frame - dataset.frames.begin())];
    if (motion) sum += motion->rotation * (left_from_imu * sample.acceleration_in_imu);
  }
  if (!(sum.norm() > 0.0)) return std::nullopt;
  return sum.normalized();
}

Eigen::Vector3d MeanCameraUp(const Poses& gauge_from_left) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& motion : gauge_from_left) {
    if (motion) sum -= motion->rotation * Eigen::Vector3d::UnitY();
  }
  return sum.normalized();
}

// RANSAC over planes through three points; the tolerance is a fiftieth of the points' median
// distance from the first camera, so that sand with rocks and a road with kerbs are planes alike.
std::optional<Eigen::Vector3d> UpFromGround(const Poses& gauge_from_left,
                                            std::span<const Eigen::Vector3d> points) {
  constexpr std::size_t kMinPoints = 50;
  constexpr int kSamples = 300;
  constexpr double kMinShare = 1.0 / 3.0, kMaxTiltCosine = 0.70711, kTolerance = 0.02;
  if (points.size() < kMinPoints) return std::nullopt;
  const Eigen::Vector3d camera_up = MeanCameraUp(gauge_from_left);
  const Eigen::Vector3d first_camera = FirstPose(gauge_from_left).translation;
  std::vector<double> distances;
  for (const Eigen::Vector3d& x : points) distances.push_back((x - first_camera).norm());
  const double tolerance = kTolerance * Median(std::move(distances));
  std::mt19937 random(static_cast<unsigned>(points.size()));
  std::uniform_int_distribution<std::size_t> draw(0, points.size() - 1);
  std::optional<Eigen::Vector3d> best;
  std::ptrdiff_t best_count = static_cast<std::ptrdiff_t>(kMinShare * double(points.size()));
  for (int sample = 0; sample < kSamples; ++sample) {
    const Eigen::Vector3d &a = points[draw(random)], &b = points[draw(random)],
                          &c = points[draw(random)];
    Eigen::Vector3d normal = (b - a).cross(c - a).normalized();
    if (normal.dot(camera_up) < 0.0) normal = -normal;
    if (!(normal.dot(camera_up) > kMaxTiltCosine)) continue;
    const auto count = std::count_if(points.begin(), points.end(), [&](const auto& x) {
      return std::abs(normal.dot(x - a)) < tolerance;
    });
    if (count > best_count) {
      best_count = count;
      best = normal;
    }
  }
  return best;
}

}  // namespace

LevelledWorld LevelWorld(const std::vector<std::optional<Rigid3>>& gauge_from_left,
                         std::span<const Eigen::Vector3d> points_in_gauge, const Dataset& dataset) {
  const Rigid3 first = FirstPose(gauge_from_left);
  LevelledWorld world;
  std::optional<Eigen::Vector3d> up = UpFromImu(gauge_from_left, dataset);
  world.up_source = WorldUp::kImu;
  if (!up) {
    up = UpFromGround(gauge_from_left, points_in_gauge);
    world.up_source = WorldUp::kGround;
  }
  if (!up) {
    up = -(first.rotation * Eigen::Vector3d::UnitY());
    world.up_source = WorldUp::kCamera;
  }
  Eigen::Vector3d heading = first.rotation * Eigen::Vector3d::UnitZ();
  heading -= heading.dot(*up) * *up;
  // A camera that looks straight down has its image's top for a heading.
  if (heading.norm() < 1e-3) {
    heading = -(first.rotation * Eigen::Vector3d::UnitY());
    heading -= heading.dot(*up) * *up;
  }
  heading.normalize();
  Eigen::Matrix3d rows;
  rows << heading.transpose(), up->cross(heading).transpose(), up->transpose();
  world.world_from_gauge.rotation = Eigen::Quaterniond(rows).normalized();
  world.world_from_gauge.translation = -(world.world_from_gauge.rotation * first.translation);
  return world;
}

}  // namespace rigmap
