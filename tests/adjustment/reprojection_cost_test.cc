#include "adjustment/reprojection_cost.h"

#include <gtest/gtest.h>

#include "tests/support/seeded_random.h"
#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

using RowMajor27 = Eigen::Matrix<double, 2, 7, Eigen::RowMajor>;
using RowMajor37 = Eigen::Matrix<double, 3, 7, Eigen::RowMajor>;

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

TEST(MotionManifolds, MinusUndoesPlus) {
  SeededRandom random;
  for (const auto& manifold : {MakeFrameManifold(), MakeRigManifold()}) {
    for (int trial = 0; trial < 20; ++trial) {
      const MotionBlock block = ToBlock(random.Motion(10.0));
      Eigen::VectorXd delta(manifold->TangentSize());
      for (double& value : delta) value = random.Uniform(-0.5, 0.5);
      Eigen::VectorXd found = Eigen::VectorXd::Zero(delta.size());
      manifold->Minus(Plus(*manifold, block, delta).data(), block.data(), found.data());
      EXPECT_LT((found - delta).norm(), 1e-12);
    }
  }
}

TEST(MotionManifolds, TheRigsKeepsTheRightCentre) {
  SeededRandom random;
  const Rigid3 right_from_left = LocCamRig().right_from_left;
  const auto manifold = MakeRigManifold();
  for (int trial = 0; trial < 20; ++trial) {
    const MotionBlock moved =
        Plus(*manifold, ToBlock(right_from_left), Eigen::VectorXd(random.Vector(0.5)));
    const Eigen::Vector3d centre = FromBlock(moved.data()).Inverse().translation;
    EXPECT_LT((centre - right_from_left.Inverse().translation).norm(), 1e-15);  // m
  }
}

// A cost's "ambient" derivatives are those by the manifold's own perturbation.
TEST(ReprojectionCost, JacobiansBelongToTheManifolds) {
  SeededRandom random;
  const StereoRig rig = LocCamRig();
  const auto frame_manifold = MakeFrameManifold(), rig_manifold = MakeRigManifold();
  for (int trial = 0; trial < 20; ++trial) {
    const Rigid3 left_from_world = random.Motion(5.0);
    const MotionBlock frame = ToBlock(left_from_world), right = ToBlock(rig.right_from_left);
    const Eigen::Vector3d x = left_from_world.Inverse() * Eigen::Vector3d(0.3, -0.2, 2.5);
    const auto cost =
        MakeReprojectionCost(rig, {.eye = Eye::kRight, .pixel = Eigen::Vector2d(400.0, 300.0)});
    const auto residual = [&](const MotionBlock& f, const MotionBlock& r) {
      const double* blocks[] = {f.data(), x.data(), r.data()};
      Eigen::Vector2d value;
      EXPECT_TRUE(cost->Evaluate(blocks, value.data(), nullptr));
      return value;
    };
    RowMajor27 by_frame, by_rig;
    Eigen::Matrix<double, 2, 3, Eigen::RowMajor> by_point;
    const double* blocks[] = {frame.data(), x.data(), right.data()};
    double* jacobians[] = {by_frame.data(), by_point.data(), by_rig.data()};
    Eigen::Vector2d value;
    ASSERT_TRUE(cost->Evaluate(blocks, value.data(), jacobians));
    constexpr double kStep = 1e-6;
    for (int axis = 0; axis < 6; ++axis) {
      const Eigen::VectorXd delta = kStep * Eigen::VectorXd::Unit(6, axis);
      const Eigen::Vector2d numeric = (residual(Plus(*frame_manifold, frame, delta), right) -
                                       residual(Plus(*frame_manifold, frame, -delta), right)) /
                                      (2.0 * kStep);
      EXPECT_LT((by_frame.col(axis) - numeric).norm(), 1e-3);  // of some 300 px per unit
    }
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::VectorXd delta = kStep * Eigen::VectorXd::Unit(3, axis);
      const Eigen::Vector2d numeric = (residual(frame, Plus(*rig_manifold, right, delta)) -
                                       residual(frame, Plus(*rig_manifold, right, -delta))) /
                                      (2.0 * kStep);
      EXPECT_LT((by_rig.col(axis) - numeric).norm(), 1e-3);
    }
  }
}

TEST(ReprojectionCost, CannotBeTakenBehindTheCamera) {
  const StereoRig rig = LocCamRig();
  const auto cost = MakeReprojectionCost(rig, {});
  const MotionBlock frame = ToBlock({}), right = ToBlock(rig.right_from_left);
  const Eigen::Vector3d x(0.0, 0.0, -1.0);
  const double* blocks[] = {frame.data(), x.data(), right.data()};
  Eigen::Vector2d value;
  EXPECT_FALSE(cost->Evaluate(blocks, value.data(), nullptr));
}

TEST(RigPrior, CountsTheTurnInSigmas) {
  const Rigid3 calibrated = LocCamRig().right_from_left;
  const double sigma_rad = 0.002;
  const auto prior = MakeRigPrior(calibrated, sigma_rad);
  const Eigen::Vector3d turn(0.001, -0.002, 0.003);
  const MotionBlock block = Plus(*MakeRigManifold(), ToBlock(calibrated), Eigen::VectorXd(turn));
  const double* blocks[] = {block.data()};
  Eigen::Vector3d residual;
  RowMajor37 jacobian;
  double* jacobians[] = {jacobian.data()};
  ASSERT_TRUE(prior->Evaluate(blocks, residual.data(), jacobians));
  EXPECT_LT((residual - turn / sigma_rad).norm(), 1e-9);
  EXPECT_LT((jacobian.leftCols<3>() - Eigen::Matrix3d::Identity() / sigma_rad).norm(), 1e-9);
}

}  // namespace
}  // namespace rigmap
