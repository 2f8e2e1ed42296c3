#include "simulation/rover_motion.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rigmap {
namespace {

constexpr double kStep_s = 0.04;  // between control points
// A wheel sinks in over about this length of ground.
constexpr double kContactLength_m = 0.12;
constexpr int kContactsAlong = 5, kContactsAcross = 3;

// Mean height of the ground under one wheel, at evenly spread places of its contact.
double HeightUnderWheel(const Eigen::Vector2d& wheel, const Eigen::Vector2d& forward,
                        const GroundHeight& ground) {
  const Eigen::Vector2d left(-forward.y(), forward.x());
  double sum_m = 0.0;
  for (int i = 0; i < kContactsAlong; ++i) {
    for (int j = 0; j < kContactsAcross; ++j) {
      const double along_m = ((i + 0.5) / kContactsAlong - 0.5) * kContactLength_m;
      const double across_m = ((j + 0.5) / kContactsAcross - 0.5) * kWheelWidth_m;
      const Eigen::Vector2d position = wheel + along_m * forward + across_m * left;
      sum_m += ground(position.x(), position.y());
    }
  }
  return sum_m / (kContactsAlong * kContactsAcross);
}

// The least-squares plane's height at the origin and its slopes forward and to the left. The
// wheels lie symmetrically, so that the three do not mix.
Eigen::Vector3d PlaneUnder(const Eigen::Matrix<double, 6, 1>& heights) {
  Eigen::Vector3d sums = Eigen::Vector3d::Zero(), squares = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < kWheelInBody.size(); ++i) {
    const Eigen::Vector3d row(1.0, kWheelInBody[i].x(), kWheelInBody[i].y());
    sums += heights[static_cast<int>(i)] * row;
    squares += row.cwiseAbs2();
  }
  return sums.cwiseQuotient(squares);
}

}  // namespace

RoverMotion::RoverMotion(RoverPath path, const GroundHeight& ground) : path_(std::move(path)) {
  const auto steps = static_cast<int>(std::ceil(path_.duration_s() / kStep_s));
  for (int step = 0; step <= steps; ++step) {
    const PlanarState state = path_.At(step * kStep_s);
    const Eigen::Rotation2Dd world_from_body(state.heading_rad);
    const Eigen::Vector2d forward = world_from_body * Eigen::Vector2d::UnitX();
    Eigen::Matrix<double, 6, 1> heights;
    for (std::size_t i = 0; i < kWheelInBody.size(); ++i) {
      const Eigen::Vector2d wheel = state.position_m + world_from_body * kWheelInBody[i];
      heights[static_cast<int>(i)] = HeightUnderWheel(wheel, forward, ground);
    }
    const Eigen::Vector3d plane = PlaneUnder(heights);
    Footing footing;
    // Slopes in world axes, so that a turn on a tilted plane leaves them as they are.
    footing << plane[0], world_from_body * Eigen::Vector2d(plane.tail<2>()), heights;
    footings_.push_back(footing);
  }
}

RoverMotion::Footing RoverMotion::FootingAt(double time_s) const {
  const double last = static_cast<double>(footings_.size() - 1);
  const double position = std::clamp(time_s / kStep_s, 0.0, last);
  const auto cell = static_cast<std::ptrdiff_t>(std::min(std::floor(position), last - 1.0));
  const double u = position - static_cast<double>(cell), v = 1.0 - u;
  const std::array<double, 4> weights{v * v * v / 6.0, (4.0 - 6.0 * u * u + 3.0 * u * u * u) / 6.0,
                                      (4.0 - 6.0 * v * v + 3.0 * v * v * v) / 6.0, u * u * u / 6.0};
  Footing footing = Footing::Zero();
  for (std::ptrdiff_t k = 0; k < 4; ++k) {
    const auto control = std::clamp<std::ptrdiff_t>(cell + k - 1, 0, std::ssize(footings_) - 1);
    footing += weights[static_cast<std::size_t>(k)] * footings_[static_cast<std::size_t>(control)];
  }
  return footing;
}

Rigid3 RoverMotion::WorldFromBody(double time_s) const {
  const PlanarState state = path_.At(time_s);
  const Footing footing = FootingAt(time_s);
  const Eigen::Vector2d heading(std::cos(state.heading_rad), std::sin(state.heading_rad));
  const Eigen::Vector2d slopes = footing.segment<2>(1);
  Eigen::Matrix3d world_from_body;
  world_from_body.col(0) =
      Eigen::Vector3d(heading.x(), heading.y(), slopes.dot(heading)).normalized();
  world_from_body.col(2) = Eigen::Vector3d(-slopes.x(), -slopes.y(), 1.0).normalized();
  world_from_body.col(1) = world_from_body.col(2).cross(world_from_body.col(0));
  return {Eigen::Quaterniond(world_from_body).normalized(),
          {state.position_m.x(), state.position_m.y(), footing[0]}};
}

std::array<double, 6> RoverMotion::WheelHeights(double time_s) const {
  const Footing footing = FootingAt(time_s);
  std::array<double, 6> heights{};
  for (std::size_t i = 0; i < heights.size(); ++i) heights[i] = footing[static_cast<int>(i) + 3];
  return heights;
}

RoverMount MountOf(const StereoRig& rig) {
  const Rigid3 loccam{Eigen::Quaterniond(-0.416, 0.572, 0.572, -0.416).normalized(),
                      {-0.382, -0.078, 0.557}};
  RoverMount mount;
  mount.body_from_imu = {Eigen::Quaterniond(0.0, 0.0, 0.0, 1.0), {0.0, 0.0, 0.545}};
  mount.imu_from_left = rig.imu_from_left.value_or(loccam);
  mount.antenna_in_left = rig.antenna_in_left.value_or(Eigen::Vector3d(0.027, -0.786, -0.888));
  mount.body_from_left = mount.body_from_imu * mount.imu_from_left;
  return mount;
}

}  // namespace rigmap
