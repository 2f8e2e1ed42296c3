#include "geometry/rigid3.h"

#include <gtest/gtest.h>

#include <numbers>

#include "geometry/adjoint.h"
#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

constexpr int kTrials = 100;
constexpr double kReach = 20.0;

double Difference(const Rigid3& a, const Rigid3& b) {
  return (a.translation - b.translation).norm() + AngleOf(a.rotation.conjugate() * b.rotation);
}

TEST(Rigid3, InverseUndoesTheMotion) {
  SeededRandom random;
  for (int i = 0; i < kTrials; ++i) {
    const Rigid3 b_from_a = random.Motion(kReach);
    const Eigen::Vector3d x_in_a = random.Vector(kReach);
    EXPECT_LT((b_from_a.Inverse() * (b_from_a * x_in_a) - x_in_a).norm(), 1e-12);
    EXPECT_LT(Difference(b_from_a * b_from_a.Inverse(), Rigid3()), 1e-12);
  }
}

TEST(Rigid3, CompositionAppliesTheRightOneFirst) {
  SeededRandom random;
  for (int i = 0; i < kTrials; ++i) {
    const Rigid3 c_from_b = random.Motion(kReach), b_from_a = random.Motion(kReach);
    const Eigen::Vector3d x_in_a = random.Vector(kReach);
    EXPECT_LT(((c_from_b * b_from_a) * x_in_a - c_from_b * (b_from_a * x_in_a)).norm(), 1e-12);
  }
}

TEST(Rigid3, LongChainsStayUnitQuaternions) {
  SeededRandom random;
  Rigid3 chain;
  for (int i = 0; i < 10000; ++i) chain = chain * random.Motion(0.1);
  EXPECT_NEAR(chain.rotation.norm(), 1.0, 1e-14);
}

TEST(Adjoint, CarriesAPerturbationFromBehindAMotionBeforeIt) {
  SeededRandom random;
  const auto perturbed = [](const Eigen::Matrix<double, 6, 1>& by) {
    return Rigid3{ExpRotation(by.tail<3>()), by.head<3>()};
  };
  for (int trial = 0; trial < kTrials; ++trial) {
    const Rigid3 motion = random.Motion(1.0);
    Eigen::Matrix<double, 6, 1> by;
    for (double& value : by) value = random.Uniform(-1e-5, 1e-5);
    EXPECT_LT(Difference(perturbed(Adjoint(motion) * by) * motion, motion * perturbed(by)), 1e-8);
  }
}

TEST(Rotation, ExpAndLogAreInverse) {
  SeededRandom random;
  for (int i = 0; i < kTrials; ++i) {
    const Eigen::Vector3d turn = LogRotation(random.Rotation());
    EXPECT_LE(turn.norm(), std::numbers::pi + 1e-12);
    EXPECT_LT((LogRotation(ExpRotation(turn)) - turn).norm(), 1e-12);
  }
}

TEST(Rotation, ExpAndLogHoldForTinyAndHalfTurns) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1.0, -2.0, 3.0).normalized();
  for (const double angle : {0.0, 1e-300, 1e-15, 1e-12, 1e-9, 1e-4, std::numbers::pi - 1e-9}) {
    const Eigen::Vector3d turn = angle * axis;
    EXPECT_LT((LogRotation(ExpRotation(turn)) - turn).norm(), 1e-14 + 1e-12 * angle) << angle;
  }
}

TEST(Rotation, BothSignsOfAQuaternionAreOneRotation) {
  SeededRandom random;
  for (int i = 0; i < kTrials; ++i) {
    const Eigen::Quaterniond rotation = random.Rotation();
    const Eigen::Quaterniond negated(-rotation.coeffs());
    EXPECT_LT((LogRotation(rotation) - LogRotation(negated)).norm(), 1e-12);
    EXPECT_NEAR(AngleOf(rotation), AngleOf(negated), 1e-12);
    EXPECT_NEAR(AngleOf(rotation), LogRotation(rotation).norm(), 1e-12);
  }
}

TEST(Rotation, ExpTurnsCounterClockwiseAboutTheAxis) {
  const Eigen::Quaterniond quarter = ExpRotation({0.0, 0.0, std::numbers::pi / 2.0});
  EXPECT_LT((quarter * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(), 1e-15);
}

TEST(Rotation, SkewIsTheCrossProductAndTheSlopeOfExp) {
  SeededRandom random;
  const Eigen::Vector3d a = random.Vector(1.0), b = random.Vector(1.0);
  EXPECT_LT((Skew(a) * b - a.cross(b)).norm(), 1e-15);
  constexpr double kStep = 1e-6;
  const Eigen::Vector3d slope = (ExpRotation(kStep * a) * b - ExpRotation(-kStep * a) * b) / 2e-6;
  EXPECT_LT((slope - Skew(a) * b).norm(), 1e-9);
}

TEST(Interpolate, MeetsBothEndsAndItsOwnReverse) {
  SeededRandom random;
  for (int i = 0; i < kTrials; ++i) {
    const Rigid3 from = random.Motion(kReach);
    const Rigid3 to = from * random.Motion(1.0, 3.0);
    EXPECT_LT(Difference(Interpolate(from, to, 0.0), from), 1e-12);
    EXPECT_LT(Difference(Interpolate(from, to, 1.0), to), 1e-12);
    const double share = random.Uniform(-0.5, 1.5);
    EXPECT_LT(Difference(Interpolate(from, to, share), Interpolate(to, from, 1.0 - share)), 1e-12);
  }
}

TEST(Interpolate, GoesAtAConstantRateAndOnBeyondTheEnd) {
  SeededRandom random;
  for (int i = 0; i < kTrials; ++i) {
    const Rigid3 from = random.Motion(kReach);
    const Rigid3 step = random.Motion(1.0, 0.5);
    const Rigid3 to = from * step * step * step * step;
    EXPECT_LT(Difference(Interpolate(from, to, 0.25), from * step), 1e-9);
    EXPECT_LT(Difference(Interpolate(from, to, 0.75), from * step * step * step), 1e-9);
    EXPECT_LT(Difference(Interpolate(from, to, 1.5), to * step * step), 1e-9);
  }
}

TEST(Interpolate, WithoutATurnGoesStraight) {
  const Rigid3 from{ExpRotation({0.3, -0.2, 1.0}), {1.0, 2.0, 3.0}};
  const Rigid3 to{from.rotation, {3.0, -2.0, 4.0}};
  const Rigid3 between = Interpolate(from, to, 0.25);
  EXPECT_LT((between.translation - Eigen::Vector3d(1.5, 1.0, 3.25)).norm(), 1e-12);
  EXPECT_LT(AngleOf(from.rotation.conjugate() * between.rotation), 1e-12);
}

TEST(Sim3, InverseUndoesTheSimilarity) {
  SeededRandom random;
  for (int i = 0; i < kTrials; ++i) {
    const Sim3 b_from_a = random.Similarity(kReach);
    const Eigen::Vector3d x_in_a = random.Vector(kReach);
    EXPECT_LT((b_from_a.Inverse() * (b_from_a * x_in_a) - x_in_a).norm(), 1e-10);
    const Sim3 nothing = b_from_a * b_from_a.Inverse();
    EXPECT_NEAR(nothing.scale, 1.0, 1e-14);
    EXPECT_LT(nothing.translation.norm(), 1e-12);
  }
}

TEST(Sim3, CompositionAppliesTheRightOneFirst) {
  SeededRandom random;
  for (int i = 0; i < kTrials; ++i) {
    const Sim3 c_from_b = random.Similarity(kReach), b_from_a = random.Similarity(kReach);
    const Eigen::Vector3d x_in_a = random.Vector(kReach);
    EXPECT_LT(((c_from_b * b_from_a) * x_in_a - c_from_b * (b_from_a * x_in_a)).norm(), 1e-9);
  }
}

// A point seen by a camera keeps its bearing, and its depth is scaled.
TEST(TransformPose, KeepsBearingsAndScalesDepths) {
  SeededRandom random;
  for (int i = 0; i < kTrials; ++i) {
    const Sim3 world_from_model = random.Similarity(kReach);
    const Rigid3 model_from_camera = random.Motion(kReach);
    const Eigen::Vector3d x_in_model = random.Vector(kReach);
    const Rigid3 world_from_camera = TransformPose(world_from_model, model_from_camera);
    const Eigen::Vector3d x_before = model_from_camera.Inverse() * x_in_model;
    const Eigen::Vector3d x_after = world_from_camera.Inverse() * (world_from_model * x_in_model);
    EXPECT_LT((x_after - world_from_model.scale * x_before).norm(), 1e-10);
  }
}

TEST(TransformPose, OfScaleOneIsAComposition) {
  SeededRandom random;
  const Rigid3 world_from_model = random.Motion(kReach), model_from_camera = random.Motion(kReach);
  const Sim3 similarity{1.0, world_from_model.rotation, world_from_model.translation};
  EXPECT_LT(Difference(TransformPose(similarity, model_from_camera),
                       world_from_model * model_from_camera),
            1e-12);
}

}  // namespace
}  // namespace rigmap
