#include "tests/dead_reckoning/driven_rover.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rigmap {
namespace {

constexpr double kRest_s = 4.0, kStep_s = 0.008, kWheelRadius_m = 0.123;
constexpr int kStepsPerWheelRow = 10, kStepsPerFrame = 125;
constexpr StampNs kFirstFrameNs = 1'448'551'418'000'000'000, kStepNs = 8'000'000;
constexpr double kHalfTrack_m = 0.4, kHalfLength_m = 0.6, kContactHeight_m = -0.54;

Rigid3 ImuFromLeft() {
  // Looking forward and 18 degrees down; IMU axes x backward, y right, z up.
  const double c = std::cos(0.314), s = std::sin(0.314);
  Eigen::Matrix3d axes;
  axes.col(0) = Eigen::Vector3d(0.0, 1.0, 0.0);
  axes.col(1) = Eigen::Vector3d(s, 0.0, -c);
  axes.col(2) = Eigen::Vector3d(-c, 0.0, -s);
  return {Eigen::Quaterniond(axes), {-0.382, -0.078, 0.557}};
}

// Of the wheel's contact, in body axes x forward, y left.
struct WheelMotion {
  double way_m = 0.0, steering_rad = 0.0;
};
WheelMotion Roll(const Eigen::Vector3d& contact_in_imu, bool is_steered, double way_m,
                 double turned_rad) {
  const double x = -contact_in_imu.x(), y = -contact_in_imu.y();
  const double ahead_m = way_m - turned_rad * y, aside_m = turned_rad * x;
  if (!is_steered || way_m == 0.0) return {ahead_m, 0.0};
  return {std::hypot(ahead_m, aside_m), std::atan2(aside_m, ahead_m)};
}

}  // namespace

Odometry ChainedOdometry(const DrivenRover& rover, const std::function<Rigid3(int)>& step) {
  Odometry odometry;
  for (int i = 0; i < static_cast<int>(rover.dataset.frames.size()); ++i) {
    OdometryFrame frame{.stamp_ns = rover.dataset.frames[i].stamp_ns,
                        .reference = std::max(0, i - 1),
                        .source = PoseSource::kOdometry,
                        .keyframe = true};
    frame.step_covariance.diagonal() << 1e-6, 1e-6, 1e-6, 1e-8, 1e-8, 1e-8;
    if (i > 0) frame.world_from_left = odometry.back().world_from_left * step(i);
    odometry.push_back(frame);
  }
  return odometry;
}

Rigid3 TrueMotion(const DrivenRover& rover, int frame) {
  return rover.gauge_from_left[frame - 1].Inverse() * rover.gauge_from_left[frame];
}

RoverWheels SixWheels() {
  RoverWheels rover{kWheelRadius_m, {}};
  for (const double x : {-kHalfLength_m, 0.0, kHalfLength_m}) {
    for (const double y : {-kHalfTrack_m, kHalfTrack_m}) {
      const int joint = static_cast<int>(rover.wheels.size()) - (x > 0.0 ? 2 : 0);
      rover.wheels.push_back(
          {{x, y, kContactHeight_m}, x == 0.0 ? std::nullopt : std::optional(joint)});
    }
  }
  return rover;
}

DeadReckoningOptions WithoutSlip() {
  DeadReckoningOptions options;
  options.wheel_slip = 0.0;
  return options;
}

DrivenRover DriveRover(int frames, const std::function<Drive(double)>& drive) {
  DrivenRover rover;
  rover.dataset.rig.imu_from_left = ImuFromLeft();
  rover.dataset.rig.right_from_left.translation.x() = -0.12;
  const RoverWheels six = SixWheels();
  const int rest_steps = static_cast<int>(std::lround(kRest_s / kStep_s));
  const int last_step = (frames - 1) * kStepsPerFrame;
  Rigid3 world_from_body;  // on the ground, x forward, z up
  const Rigid3 body_from_imu{ExpRotation({0.0, 0.0, M_PI}), {0.0, 0.0, -kContactHeight_m}};
  std::array<double, 6> angle_rad{}, rate_radps{};
  std::array<double, 4> steering_rad{};
  for (int i = -rest_steps; i <= last_step + kStepsPerFrame; ++i) {
    const double time_s = kStep_s * i;
    const StampNs stamp_ns = kFirstFrameNs + i * kStepNs;
    if (i >= 0 && i <= last_step && i % kStepsPerFrame == 0) {
      rover.dataset.frames.push_back({stamp_ns, "", ""});
      rover.dataset.inclinometer.push_back({stamp_ns, {0.0, 0.0, 9.81}});
      const Rigid3 world_from_left = world_from_body * body_from_imu * ImuFromLeft();
      rover.gauge_from_left.push_back(world_from_left);
    }
    if (i % kStepsPerWheelRow == 0) {
      rover.dataset.wheels.samples.push_back({stamp_ns, angle_rad, rate_radps, steering_rad});
    }
    const Drive now = i < 0 ? Drive{0.0, 0.0} : drive(time_s);
    // Over the step that follows; the gyro's samples lie between steps.
    const double turned_rad = now.turn_radps * kStep_s, way_m = now.speed_mps * kStep_s;
    rover.dataset.inertial.samples.push_back(
        {stamp_ns + kStepNs / 2, {0.0, 0.0, now.turn_radps}, {0.0, 0.0, 9.81}});
    for (std::size_t k = 0; k < 6; ++k) {
      const auto& [contact, joint] = six.wheels[k];
      const WheelMotion roll = Roll(contact, joint.has_value(), way_m, turned_rad);
      angle_rad[k] += roll.way_m / kWheelRadius_m;
      rate_radps[k] = roll.way_m / kWheelRadius_m / kStep_s;
      if (joint) steering_rad[*joint] = roll.steering_rad;
    }
    world_from_body = world_from_body * Rigid3{ExpRotation({0.0, 0.0, turned_rad}),
                                               {way_m * std::cos(0.5 * turned_rad),
                                                way_m * std::sin(0.5 * turned_rad), 0.0}};
  }
  const Rigid3 gauge_from_world = rover.gauge_from_left.front().Inverse();
  for (Rigid3& pose : rover.gauge_from_left) pose = gauge_from_world * pose;
  return rover;
}

VisualStep TrueStep(const DrivenRover& rover, int from, int to, double sigma_m, double sigma_rad) {
  Vector6d sigmas;
  sigmas << Eigen::Vector3d::Constant(sigma_m), Eigen::Vector3d::Constant(sigma_rad);
  return {from, to, rover.gauge_from_left[to].Inverse() * rover.gauge_from_left[from],
          sigmas.cwiseAbs2().asDiagonal()};
}

}  // namespace rigmap
