#include "tests/georeference/rover_drive.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "georeference/local_frame.h"

namespace rigmap {
namespace {

constexpr double kSpeed_m_s = 0.3, kTick_s = 0.01, kBefore_s = 5.0;
constexpr StampNs kFirstStampNs = 1448551416619000000;

StampNs StampAt(double time_s) {
  return kFirstStampNs + static_cast<StampNs>(std::llround(time_s * 1e9));
}

}  // namespace

Steering SCurve() {
  return [](double time_s) {
    return Eigen::Vector2d(kSpeed_m_s, 0.2 * std::cos(2.0 * std::numbers::pi * time_s / 30.0));
  };
}

Steering Straight() {
  return [](double) { return Eigen::Vector2d(kSpeed_m_s, 0.0); };
}

Steering Circle() {
  return [](double) { return Eigen::Vector2d(kSpeed_m_s, kSpeed_m_s / 3.0); };
}

Steering StraightAndStop() {
  return [](double time_s) {
    return Eigen::Vector2d(std::fmod(time_s + 100.0, 20.0) < 10.0 ? kSpeed_m_s : 0.0, 0.0);
  };
}

// Five seconds before and after the poses too, where fixes may fall.
RoverDrive::RoverDrive(const Steering& steering, double duration_s) : duration_s_(duration_s) {
  Eigen::Vector3d state(0.0, 0.0, 0.0);
  const int ticks = static_cast<int>((duration_s + 2.0 * kBefore_s) / kTick_s) + 2;
  for (int i = 0; i < ticks; ++i) {
    states_.push_back(state);
    const Eigen::Vector2d rate = steering(i * kTick_s - kBefore_s) * kTick_s;
    const double heading_rad = state.z() + 0.5 * rate.y();
    state += Eigen::Vector3d(rate.x() * std::cos(heading_rad), rate.x() * std::sin(heading_rad),
                             rate.y());
  }
}

Rigid3 RoverDrive::WorldFromLeft(double time_s) const {
  const double tick = (time_s + kBefore_s) / kTick_s;
  const auto before = static_cast<std::size_t>(tick);
  const double share = tick - std::floor(tick);
  const Eigen::Vector3d state = (1.0 - share) * states_.at(before) + share * states_.at(before + 1);
  Eigen::Matrix3d level_from_camera;  // x forward, y left, z up from x right, y down, z forward
  level_from_camera << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const Eigen::Quaterniond rotation =
      Eigen::AngleAxisd(state.z(), Eigen::Vector3d::UnitZ()) *
      Eigen::AngleAxisd(18.0 * std::numbers::pi / 180.0, Eigen::Vector3d::UnitY()) *
      Eigen::Quaterniond(level_from_camera);
  return {rotation, Eigen::Vector3d(state.x(), state.y(), 1.1)};
}

Trajectory RoverDrive::Poses(double sigma_m, SeededRandom& random) const {
  Trajectory poses;
  for (double time_s = 0.0; time_s <= duration_s_; time_s += 0.4) {
    TimedPose pose;
    pose.stamp_ns = StampAt(time_s);
    pose.world_from_left = WorldFromLeft(time_s);
    pose.world_from_left.translation += random.Noise(sigma_m);
    pose.source = PoseSource::kAdjusted;
    poses.push_back(pose);
  }
  return poses;
}

std::vector<GnssFix> RoverDrive::Fixes(const Rigid2& plane_from_world, double clock_offset_s,
                                       SeededRandom& random) const {
  const LocalFrame katwijk({52.2141, 4.4004, 6.0});
  std::vector<GnssFix> fixes;
  for (double time_s = -4.0 + random.Uniform(0.0, 3.0); time_s < duration_s_ + 4.0; time_s += 3.0) {
    GnssFix fix;
    fix.stamp_ns = StampAt(time_s + clock_offset_s);
    fix.status = kRtkFixed;
    fix.sigma_enu_m = {0.004, 0.005, 0.009};
    const Eigen::Vector3d antenna = WorldFromLeft(time_s) * kAntennaInLeft;
    Eigen::Vector3d enu;
    enu << plane_from_world * antenna.head<2>(), antenna.z();
    enu += random.Noise(1.0).cwiseProduct(fix.sigma_enu_m);
    const Geodetic position = katwijk.ToGeodetic(enu);
    fix.latitude_deg = position.latitude_deg;
    fix.longitude_deg = position.longitude_deg;
    fix.altitude_m = position.altitude_m;
    fixes.push_back(fix);
  }
  return fixes;
}

}  // namespace rigmap
