#include "raster/internal/view_axes.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace rigmap {
namespace {

constexpr double kMinExtent_m = 0.1;
constexpr double kStep_m = 0.05;
constexpr double kFarthest_m = 1e9;  // what lies farther counts as there
constexpr double kRadPerDegree = std::numbers::pi / 180.0;

Eigen::Vector2d PositionOf(const TimedPose& pose) {
  return pose.world_from_left.translation.head<2>();
}

}  // namespace

Eigen::Vector3d DrivingDirection(const Trajectory& trajectory) {
  if (trajectory.empty()) return Eigen::Vector3d::UnitX();
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const TimedPose& pose : trajectory) mean += PositionOf(pose) / trajectory.size();
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const TimedPose& pose : trajectory) {
    spread += (PositionOf(pose) - mean) * (PositionOf(pose) - mean).transpose() / trajectory.size();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(spread);
  if (4.0 * std::sqrt(solver.eigenvalues()(1)) < kMinExtent_m) return Eigen::Vector3d::UnitX();
  Eigen::Vector2d direction = solver.eigenvectors().col(1);
  const Eigen::Vector2d way = PositionOf(trajectory.back()) - PositionOf(trajectory.front());
  // A loop ends where it began: then it is the first heading, x, that decides.
  const double along = way.norm() > kMinExtent_m ? way.dot(direction) : direction.x();
  if (along < 0.0) direction = -direction;
  return {direction.x(), direction.y(), 0.0};
}

ViewAxes TopView() {
  return {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()};
}

ViewAxes SideView(const Eigen::Vector3d& driving_direction) {
  return {driving_direction, Eigen::Vector3d::UnitZ(),
          driving_direction.cross(Eigen::Vector3d::UnitZ())};
}

ViewAxes ObliqueView(const Eigen::Vector3d& driving_direction) {
  constexpr double kTurn_rad = 50.0 * kRadPerDegree;  // of the view away from straight behind
  constexpr double kDown_rad = 35.0 * kRadPerDegree;
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d ahead = Eigen::AngleAxisd(kTurn_rad, up) * driving_direction;
  const Eigen::Vector3d towards = -std::cos(kDown_rad) * ahead + std::sin(kDown_rad) * up;
  const Eigen::Vector3d right = ahead.cross(up);
  return {right, towards.cross(right), towards};
}

void RangeCounter::Add(double value_m) {
  ++counts_[std::llround(std::clamp(value_m, -kFarthest_m, kFarthest_m) / kStep_m)];
  ++total_;
}

RangeCounter::Range RangeCounter::Trimmed(double share) const {
  const auto allowed = static_cast<std::uint64_t>(share * static_cast<double>(total_));
  auto low = counts_.begin();
  for (std::uint64_t left_out = low->second; left_out <= allowed; left_out += low->second) ++low;
  auto high = counts_.rbegin();
  for (std::uint64_t left_out = high->second; left_out <= allowed; left_out += high->second) ++high;
  return {kStep_m * (static_cast<double>(low->first) - 0.5),
          kStep_m * (static_cast<double>(high->first) + 0.5)};
}

}  // namespace rigmap
