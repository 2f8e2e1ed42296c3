#include "tests/support/synthetic_rover.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rigmap {
namespace {

TEST(SyntheticRover, FeaturesAreProjectionsWithinNoise) {
  const SyntheticRover rover = MakeSyntheticRover({.frames = 4, .pixel_sigma = 0.2});
  double squares_px2 = 0.0;
  int coordinates = 0;
  for (std::size_t frame = 0; frame < rover.frames.size(); ++frame) {
    const auto& features = rover.frames[frame].features;
    ASSERT_EQ(features.size(), rover.point_of_feature[frame].size());
    ASSERT_EQ(features.size(), rover.frames[frame].descriptors.size());
    ASSERT_EQ(features.size(), rover.frames[frame].patches.size());
    EXPECT_GT(features.size(), 300u);
    for (std::size_t i = 0; i < features.size(); ++i) {
      const Eigen::Vector3d x_in_left =
          rover.world_from_left[frame].Inverse() * rover.points[rover.point_of_feature[frame][i]];
      squares_px2 += (*Project(rover.rig.left.camera, x_in_left) - features[i].left).squaredNorm();
      coordinates += 2;
      if (!features[i].right) continue;
      const Eigen::Vector3d x_in_right = rover.rig.right_from_left * x_in_left;
      squares_px2 +=
          (*Project(rover.rig.right.camera, x_in_right) - *features[i].right).squaredNorm();
      coordinates += 2;
    }
  }
  EXPECT_NEAR(std::sqrt(squares_px2 / coordinates), 0.2, 0.01);
}

TEST(SyntheticRover, DrivesStepsAndTurnsLeft) {
  const SyntheticRover rover =
      MakeSyntheticRover({.frames = 3, .step_m = 0.5, .curve_rad_per_m = 0.2});
  const Eigen::Vector3d step =
      rover.world_from_left[2].translation - rover.world_from_left[1].translation;
  EXPECT_NEAR(step.norm(), 0.5, 1e-12);
  EXPECT_GT(step.y(), 0.0);
  EXPECT_EQ(rover.world_from_left[0].translation.norm(), 0.0);
  const Eigen::Vector3d forward = rover.world_from_left[0].rotation * Eigen::Vector3d::UnitZ();
  EXPECT_NEAR(std::asin(-forward.z()), 18.0 * M_PI / 180.0, 1e-12);  // rad below the horizon
  EXPECT_NEAR(forward.y(), 0.0, 1e-12);
  EXPECT_GT(forward.x(), 0.0);
}

TEST(SyntheticRover, ReliefIsWithinItsBounds) {
  const SyntheticRover rover = MakeSyntheticRover({.frames = 2, .relief_m = 0.0});
  for (const auto& point : rover.points) ASSERT_NEAR(point.z(), -1.1, 1e-12);  // m, flat ground
}

TEST(SyntheticRover, MatchesJoinEqualPointsAndDescriptors) {
  const SyntheticRover rover = MakeSyntheticRover({.frames = 2});
  const auto matches = TrueMatches(rover, 0, 1);
  EXPECT_GT(matches.size(), 250u);
  for (const auto& [a, b] : matches) {
    ASSERT_EQ(rover.point_of_feature[0][a], rover.point_of_feature[1][b]);
    ASSERT_EQ(rover.frames[0].descriptors[a], rover.frames[1].descriptors[b]);
  }
}

TEST(SyntheticRover, EqualSeedsGiveEqualRovers) {
  const SyntheticRover a = MakeSyntheticRover({.frames = 2, .seed = 5});
  const SyntheticRover b = MakeSyntheticRover({.frames = 2, .seed = 5});
  const SyntheticRover c = MakeSyntheticRover({.frames = 2, .seed = 6});
  EXPECT_EQ(a.frames[1].features[0].left, b.frames[1].features[0].left);
  EXPECT_NE(a.frames[1].features[0].left, c.frames[1].features[0].left);
}

}  // namespace
}  // namespace rigmap
