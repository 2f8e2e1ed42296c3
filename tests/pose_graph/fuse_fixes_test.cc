#include "pose_graph/fuse_fixes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace rigmap {
namespace {

const Eigen::Vector3d kAntenna(0.2, -0.9, -0.5);  // 1.05 m from the left camera

// A way of 40 m, turning by 120 degrees and back, a pose every 0.2 m and second; the camera looks
// along it. The images make it 0.3 % too long and turn a little too far at each step.
struct Drive {
  Trajectory truth, images;
  Rigid3 enu_from_world{Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ())),
                        {5.0, -3.0, 2.0}};

  Drive() {
    constexpr int kPoses = 200;
    constexpr double kScale = 1.003, kTurn_rad = 1e-5;
    Rigid3 pose, seen;
    for (int i = 0; i < kPoses; ++i) {
      truth.push_back(At(i, pose));
      images.push_back(At(i, seen));
      // Camera axes: z forward, x right, y down. Turning left about -y.
      // Left, then right: on one circle a clock that is off is nothing but a turn of the whole.
      const double turn = std::numbers::pi * (i < kPoses / 2 ? 4.0 : -4.0) / 3.0 / kPoses;
      const Rigid3 step{Eigen::Quaterniond(Eigen::AngleAxisd(-turn, Eigen::Vector3d::UnitY())),
                        {0.0, 0.0, 0.2}};
      Rigid3 off = step;
      off.translation *= kScale;
      off.rotation = off.rotation *
                     Eigen::Quaterniond(Eigen::AngleAxisd(-kTurn_rad, Eigen::Vector3d::UnitY()));
      pose = pose * step;
      seen = seen * off;
    }
  }

  static TimedPose At(int i, const Rigid3& world_level_from_left) {
    // Camera to a world with z up: x forward.
    Eigen::Matrix3d axes;
    axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    const Rigid3 world_from_first{Eigen::Quaterniond(axes), {0.0, 0.0, 1.0}};
    TimedPose pose{.stamp_ns = i * 1'000'000'000LL,
                   .world_from_left = world_from_first * world_level_from_left};
    const double share = i / 200.0;
    pose.sigmas << 0.11 * share, 0.11 * share, 0.11 * share, 1e-3 * share, 1e-3 * share,
        1e-3 * share;
    pose.position_covariance = Eigen::Matrix3d::Identity() * 0.0121 * share * share;
    return pose;
  }

  // A fix every two seconds, 5 mm off in each axis; its clock ahead by so much.
  std::vector<AntennaFix> Fixes(double clock_s = 0.0) const {
    std::mt19937 random(3);
    std::normal_distribution<double> noise(0.0, 0.005);
    std::vector<AntennaFix> fixes;
    for (double time_s = 3.3; time_s < 195.0; time_s += 2.0) {
      const auto antenna = AntennaAt(truth, time_s, kAntenna, 3.0);
      const Eigen::Vector3d error(noise(random), noise(random), noise(random));
      fixes.push_back(
          {time_s + clock_s, enu_from_world * *antenna + error, Eigen::Vector3d::Constant(0.005)});
    }
    return fixes;
  }

  FixFusion Fusion() const { return {kAntenna, enu_from_world, 0.005, std::nullopt, 3.0}; }

  // Root mean square distance of the antenna from its true places, both in ENU.
  double Error(const std::vector<Rigid3>& poses, const Rigid3& enu) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      sum += (enu * poses[i] * kAntenna - enu_from_world * truth[i].world_from_left * kAntenna)
                 .squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(poses.size()));
  }
  double ErrorOfImages() const {
    std::vector<Rigid3> poses;
    for (const TimedPose& pose : images) poses.push_back(pose.world_from_left);
    return Error(poses, enu_from_world);
  }
};

TEST(FuseFixes, GoodFixesTakeTheDriftOut) {
  const Drive drive;
  const auto fixes = drive.Fixes();
  const auto fused = FuseFixes(drive.images, fixes, drive.Fusion());
  ASSERT_TRUE(fused);
  EXPECT_GT(drive.ErrorOfImages(), 0.03);
  EXPECT_LT(drive.Error(fused->world_from_left, fused->enu_from_world), 0.006);
  EXPECT_NEAR(fused->scale, 1.0 / 1.003, 5e-4);
  // The world stays where it was.
  EXPECT_LT(
      (fused->world_from_left[0].translation - drive.images[0].world_from_left.translation).norm(),
      1e-12);
  EXPECT_EQ(std::ranges::count(fused->used, 0), 0);
  EXPECT_LT(fused->chi2 / fused->degrees_of_freedom, 1.5);
}

TEST(FuseFixes, AClockThatIsOffIsFound) {
  const Drive drive;
  FixFusion fusion = drive.Fusion();
  const auto fixes = drive.Fixes(0.3);
  const auto held = FuseFixes(drive.images, fixes, fusion);
  fusion.clock_sigma_s = 0.5;
  const auto fused = FuseFixes(drive.images, fixes, fusion);
  ASSERT_TRUE(fused);
  EXPECT_NEAR(fused->clock_offset_s, 0.3, 0.03);
  EXPECT_LT(drive.Error(fused->world_from_left, fused->enu_from_world), 0.006);
  // 0.3 s at 0.2 m/s are 6 cm along a path that turns.
  ASSERT_TRUE(held);
  EXPECT_GT(drive.Error(held->world_from_left, held->enu_from_world), 0.02);
}

TEST(FuseFixes, AJumpIsNotBelieved) {
  const Drive drive;
  auto fixes = drive.Fixes();
  // Two metres over twenty, as after a wrong count of the carrier's cycles.
  for (std::size_t i = 40; i < 50; ++i) fixes[i].x_in_enu.x() += 2.0;
  fixes[70].x_in_enu.y() += 5.0;
  const auto fused = FuseFixes(drive.images, fixes, drive.Fusion());
  ASSERT_TRUE(fused);
  for (std::size_t i = 0; i < fixes.size(); ++i) {
    EXPECT_EQ(fused->used[i] == 0, (i >= 40 && i < 50) || i == 70) << i;
  }
  EXPECT_LT(drive.Error(fused->world_from_left, fused->enu_from_world), 0.006);
}

TEST(FuseFixes, FixesOfAnotherDriveAreRefused) {
  const Drive drive;
  auto fixes = drive.Fixes();
  for (std::size_t i = 0; i < fixes.size(); ++i) {
    fixes[i].x_in_enu += Eigen::Vector3d(0.0, 3.0 * (i % 2), 0.5 * static_cast<double>(i % 5));
  }
  const auto fused = FuseFixes(drive.images, fixes, drive.Fusion());
  // Believed only if their noise is raised to what they scatter.
  EXPECT_TRUE(!fused || fused->fix_noise_factor > 50.0);
}

TEST(FuseFixes, TooFewAndOutsideTheDriveIsNothing) {
  const Drive drive;
  auto fixes = drive.Fixes();
  fixes.resize(3);
  EXPECT_FALSE(FuseFixes(drive.images, fixes, drive.Fusion()));
  fixes = drive.Fixes();
  for (AntennaFix& fix : fixes) fix.time_s += 1000.0;
  EXPECT_FALSE(FuseFixes(drive.images, fixes, drive.Fusion()));
}

}  // namespace
}  // namespace rigmap
