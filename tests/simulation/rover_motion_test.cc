#include "simulation/rover_motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "dataset/rig_file.h"
#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

double RoughGround(double east_m, double north_m) {
  return 0.1 * std::sin(0.9 * east_m + 0.3) * std::cos(0.7 * north_m) +
         0.01 * std::sin(20.0 * east_m) * std::sin(17.0 * north_m + 1.0);
}

RoverPath Path(const std::string& shape) { return MakeRoverPath({shape, 40, 0.2, 1.25, 0.5}); }

TEST(RoverMotion, LiesOnATiltedPlaneExactly) {
  SeededRandom random;
  for (const std::string& shape : kPathNames) {
    const double to_east = random.Uniform(-0.3, 0.3), to_north = random.Uniform(-0.3, 0.3);
    const RoverMotion motion(Path(shape), [&](double east_m, double north_m) {
      return 2.0 + to_east * east_m + to_north * north_m;
    });
    const Eigen::Vector3d up = Eigen::Vector3d(-to_east, -to_north, 1.0).normalized();
    for (double time_s = -3.0; time_s < 53.0; time_s += 0.31) {
      const Rigid3 world_from_body = motion.WorldFromBody(time_s);
      const PlanarState state = motion.path().At(time_s);
      EXPECT_LT((world_from_body.rotation * Eigen::Vector3d::UnitZ() - up).norm(), 1e-9);
      const Eigen::Vector3d forward = world_from_body.rotation * Eigen::Vector3d::UnitX();
      EXPECT_NEAR(std::remainder(std::atan2(forward.y(), forward.x()) - state.heading_rad,
                                 2.0 * std::numbers::pi),
                  0.0, 1e-9);
      const Eigen::Vector3d& position = world_from_body.translation;
      EXPECT_LT((position.head<2>() - state.position_m).norm(), 1e-12);
      // Smoothing over time cuts a corner where the speed changes.
      EXPECT_NEAR(position.z(), 2.0 + to_east * position.x() + to_north * position.y(), 1e-4);  // m
    }
  }
}

TEST(RoverMotion, GoesUpAndDownWithTheGround) {
  const RoverMotion motion(Path("s-curve"), RoughGround);
  const RoverMotion raised(Path("s-curve"), [](double east_m, double north_m) {
    return 1.5 + RoughGround(east_m, north_m);
  });
  for (double time_s = 0.0; time_s < 50.0; time_s += 0.7) {
    const Rigid3 low = motion.WorldFromBody(time_s), high = raised.WorldFromBody(time_s);
    EXPECT_LT((high.translation - low.translation - Eigen::Vector3d(0.0, 0.0, 1.5)).norm(), 1e-9);
    EXPECT_LT(AngleOf(low.rotation.conjugate() * high.rotation), 1e-9);
    EXPECT_NEAR(low.translation.z(), RoughGround(low.translation.x(), low.translation.y()), 0.05);
  }
}

TEST(RoverMotion, IsSmoothInTime) {
  const RoverMotion motion(Path("traverse3"), RoughGround);
  constexpr double kStep_s = 0.002;
  Eigen::Vector3d last_velocity = Eigen::Vector3d::Zero(), last_rate = Eigen::Vector3d::Zero();
  for (double time_s = 0.0; time_s < 50.0; time_s += kStep_s) {
    const Rigid3 from = motion.WorldFromBody(time_s), to = motion.WorldFromBody(time_s + kStep_s);
    const Eigen::Vector3d velocity = (to.translation - from.translation) / kStep_s;
    const Eigen::Vector3d rate = LogRotation(from.rotation.conjugate() * to.rotation) / kStep_s;
    EXPECT_LT((velocity - last_velocity).norm() / kStep_s, 2.0);  // m/s^2
    EXPECT_LT((rate - last_rate).norm() / kStep_s, 3.0);          // rad/s^2
    last_velocity = velocity;
    last_rate = rate;
  }
}

TEST(RoverMotion, WheelsFeelTheGroundUnderThem) {
  const RoverMotion motion(Path("loop"), [](double east_m, double north_m) {
    return 0.05 * east_m + 0.02 * north_m * north_m;
  });
  for (double time_s = 1.0; time_s < 50.0; time_s += 1.7) {
    const PlanarState state = motion.path().At(time_s);
    const auto heights = motion.WheelHeights(time_s);
    for (std::size_t i = 0; i < heights.size(); ++i) {
      const Eigen::Vector2d wheel =
          state.position_m + Eigen::Rotation2Dd(state.heading_rad) * kWheelInBody[i];
      EXPECT_NEAR(heights[i], 0.05 * wheel.x() + 0.02 * wheel.y() * wheel.y(), 1e-3);  // m
    }
  }
}

TEST(RoverMount, StandsUprightWithLocCamsMountWhereTheRigSaysNothing) {
  const RoverMount mount = MountOf(StereoRig{});
  EXPECT_LT(
      (mount.body_from_imu * Eigen::Vector3d(1.0, 2.0, 3.0) - Eigen::Vector3d(-1.0, -2.0, 3.545))
          .norm(),
      1e-12);
  EXPECT_NEAR(mount.body_from_left.translation.z(), 1.102, 1e-9);  // m
  const Eigen::Vector3d view = mount.body_from_left.rotation * Eigen::Vector3d::UnitZ();
  EXPECT_NEAR(std::asin(-view.z()) * 180.0 / std::numbers::pi, 17.95, 0.01);
  EXPECT_NEAR(view.y(), 0.0, 1e-9);
  EXPECT_NEAR(mount.antenna_in_left.norm(), 1.19, 0.01);
  EXPECT_GT(mount.AntennaInBody().z(), 2.0);
}

TEST(RoverMount, TakesWhatTheRigSays) {
  SeededRandom random;
  StereoRig rig;
  rig.imu_from_left = random.Motion(1.0);
  rig.antenna_in_left = random.Vector(1.0);
  const RoverMount mount = MountOf(rig);
  const Eigen::Vector3d x_in_left = random.Vector(3.0);
  EXPECT_LT(
      (mount.body_from_left * x_in_left - mount.body_from_imu * (*rig.imu_from_left * x_in_left))
          .norm(),
      1e-12);
  EXPECT_EQ(mount.antenna_in_left, *rig.antenna_in_left);
}

TEST(RoverMount, AgreesWithTheRenderedBeach) {
  const char* data = std::getenv("RIGMAP_DATA");
  if (data == nullptr) GTEST_SKIP() << "RIGMAP_DATA is not set";
  const std::filesystem::path beach = std::filesystem::path(data) / "beach-dev";
  const RoverMount mount = MountOf(ReadRigFile(beach / "rig.yaml"));
  const auto truth = nlohmann::json::parse(std::ifstream(beach / "truth/Part1/truth.json"));
  const Eigen::Matrix3d rotation = mount.body_from_left.rotation.toRotationMatrix();
  for (int row = 0; row < 3; ++row) {
    const auto& expected = truth.at("body_T_leftcam").at(static_cast<std::size_t>(row));
    EXPECT_NEAR(mount.body_from_left.translation[row], expected.at(3), 1e-4);  // m
    for (int column = 0; column < 3; ++column) {
      EXPECT_NEAR(rotation(row, column), expected.at(static_cast<std::size_t>(column)), 1e-6);
    }
    EXPECT_NEAR(mount.AntennaInBody()[row],
                truth.at("antenna_body_flu_m").at(static_cast<std::size_t>(row)), 1e-4);  // m
  }
}

}  // namespace
}  // namespace rigmap
