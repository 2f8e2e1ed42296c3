#include "geometry/rectification.h"

#include <gtest/gtest.h>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

// A right camera 5 to 60 cm to the right of the left one, turned by up to 0.2 rad.
Rigid3 RandomRightFromLeft(SeededRandom& random) {
  const double baseline_m = random.Uniform(0.05, 0.6);
  const Eigen::Vector3d right_in_left =
      baseline_m * (Eigen::Vector3d::UnitX() + random.Vector(0.1)).normalized();
  return Rigid3{random.Rotation(0.2), right_in_left}.Inverse();
}

TEST(Rectify, PutsPointsOnTheSameRowWithDisparityBaselineByDepth) {
  SeededRandom random;
  for (int i = 0; i < 200; ++i) {
    const Rigid3 right_from_left = RandomRightFromLeft(random);
    const RectifiedAxes axes = Rectify(right_from_left);
    const Eigen::Vector3d x_in_left(random.Uniform(-0.5, 0.5), random.Uniform(-0.5, 0.5),
                                    random.Uniform(2.0, 20.0));
    const Eigen::Vector2d left = Turn(axes.rectified_from_left, x_in_left.hnormalized());
    const Eigen::Vector2d right =
        Turn(axes.rectified_from_right, (right_from_left * x_in_left).hnormalized());
    const double depth_m = (axes.rectified_from_left * x_in_left).z();
    EXPECT_NEAR(left.y(), right.y(), 1e-12);
    EXPECT_NEAR(left.x() - right.x(), axes.baseline_m / depth_m, 1e-12);
  }
}

TEST(Rectify, LeavesAParallelRigUnchanged) {
  const RectifiedAxes axes = Rectify({Eigen::Quaterniond::Identity(), {-0.24, 0.0, 0.0}});
  EXPECT_LT(AngleOf(axes.rectified_from_left), 1e-15);
  EXPECT_LT(AngleOf(axes.rectified_from_right), 1e-15);
  EXPECT_EQ(axes.baseline_m, 0.24);
}

TEST(Rectify, TurnsBothViewsByTheSameAngleAboutTheBaseline) {
  // Cameras toed in by the same angle: each is turned back by it.
  constexpr double kToe_rad = 0.03;
  const Rigid3 left_from_middle{ExpRotation({0.0, -kToe_rad, 0.0}), Eigen::Vector3d::Zero()};
  const Rigid3 middle_from_right{ExpRotation({0.0, -kToe_rad, 0.0}), {0.12, 0.0, 0.0}};
  const RectifiedAxes axes = Rectify((left_from_middle * middle_from_right).Inverse());
  EXPECT_NEAR(AngleOf(axes.rectified_from_left), kToe_rad, 1e-12);
  EXPECT_NEAR(AngleOf(axes.rectified_from_right), kToe_rad, 1e-12);
}

TEST(Rectify, GivesOneRotationBetweenTheViews) {
  SeededRandom random;
  for (int i = 0; i < 100; ++i) {
    const Rigid3 right_from_left = RandomRightFromLeft(random);
    const RectifiedAxes axes = Rectify(right_from_left);
    const Eigen::Quaterniond found =
        axes.rectified_from_right.conjugate() * axes.rectified_from_left;
    EXPECT_LT(AngleOf(found.conjugate() * right_from_left.rotation), 1e-12);
    EXPECT_NEAR(axes.baseline_m, right_from_left.translation.norm(), 1e-15);
  }
}

}  // namespace
}  // namespace rigmap
