#include "adjustment/internal/reprojection_cost.h"

#include <gtest/gtest.h>

#include "tests/support/seeded_random.h"
#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

using RowMajor27 = Eigen::Matrix<double, 2, 7, Eigen::RowMajor>;

MotionBlock Plus(const ceres::Manifold& manifold, const MotionBlock& block,
                 const Eigen::VectorXd& delta) {
  MotionBlock moved;
  manifold.Plus(block.data(), delta.data(), moved.data());
  return moved;
}

TEST(MotionBlocks, GoRoundAndBack) {
  SeededRandom random;
  for (int trial = 0; trial < 20; ++trial) {
    const Rigid3 motion = random.Motion(10.0);
    const Rigid3 back = FromBlock(ToBlock(motion).data());
    EXPECT_EQ(back.rotation.coeffs(), motion.rotation.coeffs());
    EXPECT_EQ(back.translation, motion.translation);
  }
}

TEST(FrameManifold, MinusUndoesPlus) {
  SeededRandom random;
  const auto manifold = MakeFrameManifold();
  for (int trial = 0; trial < 20; ++trial) {
    const MotionBlock block = ToBlock(random.Motion(10.0));
    Eigen::VectorXd delta(manifold->TangentSize());
    for (double& value : delta) value = random.Uniform(-0.5, 0.5);
    Eigen::VectorXd found = Eigen::VectorXd::Zero(delta.size());
    manifold->Minus(Plus(*manifold, block, delta).data(), block.data(), found.data());
    EXPECT_LT((found - delta).norm(), 1e-12);
  }
}

// A cost's "ambient" derivatives are those by the manifold's own perturbation.
TEST(ReprojectionCost, JacobianBelongsToTheManifold) {
  SeededRandom random;
  const StereoRig rig = LocCamRig();
  const auto manifold = MakeFrameManifold();
  for (int trial = 0; trial < 20; ++trial) {
    const Rigid3 left_from_world = random.Motion(5.0);
    const MotionBlock frame = ToBlock(left_from_world);
    const Eigen::Vector3d x = left_from_world.Inverse() * Eigen::Vector3d(0.3, -0.2, 2.5);
    const auto cost =
        MakeReprojectionCost(rig, {.eye = Eye::kRight, .pixel = Eigen::Vector2d(400.0, 300.0)});
    const auto residual = [&](const MotionBlock& f) {
      const double* blocks[] = {f.data(), x.data()};
      Eigen::Vector2d value;
      EXPECT_TRUE(cost->Evaluate(blocks, value.data(), nullptr));
      return value;
    };
    RowMajor27 by_frame;
    Eigen::Matrix<double, 2, 3, Eigen::RowMajor> by_point;
    const double* blocks[] = {frame.data(), x.data()};
    double* jacobians[] = {by_frame.data(), by_point.data()};
    Eigen::Vector2d value;
    ASSERT_TRUE(cost->Evaluate(blocks, value.data(), jacobians));
    constexpr double kStep = 1e-6;
    for (int axis = 0; axis < 6; ++axis) {
      const Eigen::VectorXd delta = kStep * Eigen::VectorXd::Unit(6, axis);
      const Eigen::Vector2d numeric =
          (residual(Plus(*manifold, frame, delta)) - residual(Plus(*manifold, frame, -delta))) /
          (2.0 * kStep);
      EXPECT_LT((by_frame.col(axis) - numeric).norm(), 1e-3);  // of some 300 px per unit
    }
  }
}

TEST(ReprojectionCost, CannotBeTakenBehindTheCamera) {
  const StereoRig rig = LocCamRig();
  const auto cost = MakeReprojectionCost(rig, {});
  const MotionBlock frame = ToBlock({});
  const Eigen::Vector3d x(0.0, 0.0, -1.0);
  const double* blocks[] = {frame.data(), x.data()};
  Eigen::Vector2d value;
  EXPECT_FALSE(cost->Evaluate(blocks, value.data(), nullptr));
}

}  // namespace
}  // namespace rigmap
