#include "pose_graph/fuse_fixes.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/antenna_drive.h"
#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

TEST(FuseFixes, GoodFixesTakeTheDriftOut) {
  const AntennaDrive drive;
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
  EXPECT_LT(fused->chi2_as_stated / fused->degrees_of_freedom, 1.25);
}

// Three centimetres of noise, stated as 5 mm.
TEST(FuseFixes, RaisedSigmasDoNotHideThatTheStatedOnesAreTooSmall) {
  const AntennaDrive drive;
  auto fixes = drive.Fixes();
  SeededRandom random;
  for (AntennaFix& fix : fixes) fix.x_in_enu += random.Noise(0.03);
  const auto fused = FuseFixes(drive.images, fixes, drive.Fusion());
  ASSERT_TRUE(fused);
  EXPECT_LT(fused->chi2 / fused->degrees_of_freedom, 1.5);
  EXPECT_GT(fused->chi2_as_stated / fused->degrees_of_freedom, 10.0);
}

TEST(FuseFixes, AClockThatIsOffIsFound) {
  const AntennaDrive drive;
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
  const AntennaDrive drive;
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
  const AntennaDrive drive;
  auto fixes = drive.Fixes();
  for (std::size_t i = 0; i < fixes.size(); ++i) {
    fixes[i].x_in_enu += Eigen::Vector3d(0.0, 3.0 * (i % 2), 0.5 * static_cast<double>(i % 5));
  }
  const auto fused = FuseFixes(drive.images, fixes, drive.Fusion());
  // Believed only if their noise is raised to what they scatter.
  EXPECT_TRUE(!fused || fused->fix_noise_factor > 50.0);
}

TEST(AntennaAt, LiesBetweenThePosesAroundATime) {
  const AntennaDrive drive;
  const auto at = [&](const Trajectory& poses, double time_s) {
    return AntennaAt(poses, time_s, kAntenna, 3.0);
  };
  const auto antenna = [&](std::size_t i) -> Eigen::Vector3d {
    return drive.truth[i].world_from_left * kAntenna;
  };
  EXPECT_LT((*at(drive.truth, 0.0) - antenna(0)).norm(), 1e-12);
  EXPECT_LT((*at(drive.truth, 7.0) - antenna(7)).norm(), 1e-12);
  EXPECT_LT((*at(drive.truth, 199.0) - antenna(199)).norm(), 1e-12);
  EXPECT_LT((*at(drive.truth, 7.25) - (0.75 * antenna(7) + 0.25 * antenna(8))).norm(), 1e-3);
  EXPECT_FALSE(at(drive.truth, -0.1));
  EXPECT_FALSE(at(drive.truth, 199.1));
  EXPECT_FALSE(at({drive.truth.front()}, 0.0));
  EXPECT_FALSE(at({}, 0.0));
}

TEST(FuseFixes, TooFewAndOutsideTheDriveIsNothing) {
  const AntennaDrive drive;
  auto fixes = drive.Fixes();
  fixes.resize(3);
  EXPECT_FALSE(FuseFixes(drive.images, fixes, drive.Fusion()));
  fixes = drive.Fixes();
  for (AntennaFix& fix : fixes) fix.time_s += 1000.0;
  EXPECT_FALSE(FuseFixes(drive.images, fixes, drive.Fusion()));
}

}  // namespace
}  // namespace rigmap
