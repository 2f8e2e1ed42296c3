#include "adjustment/internal/bundle_solver.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/adjustment/rover_bundle.h"

namespace rigmap {
namespace {

constexpr double kNoLimit_px = 1e9;

// The rover with noise of 0.3 px.
class BundleSolverTest : public testing::Test {
 protected:
  void SetUp() override {
    rover_ =
        MakeSyntheticRover({.frames = 6, .points_per_m2 = 20.0, .pixel_sigma = 0.3, .seed = 23});
    const Correspondences correspondences = RoverCorrespondences(rover_, 4);
    bundle_ = {rover_.rig, InverseOf(AllOf(rover_.world_from_left)), {}};
    bundle_.points = TriangulateTracks(BuildTracks(correspondences, false), correspondences,
                                       rover_.rig, bundle_.left_from_world, 8.0, 100.0);
    ASSERT_GT(bundle_.points.size(), 600U) << "several parts";
  }

  void DisturbSome() {
    for (std::size_t i = 0; i < bundle_.points.size(); i += 7) {
      bundle_.points[i].observations.front().pixel += Eigen::Vector2d(3.0, -2.0);
    }
  }

  // d(half the sum of the loss) by a turn and a shift of a frame, from central differences.
  Vector6d Gradient(int frame, double huber_px) const {
    constexpr double kStep = 1e-6;
    Vector6d gradient;
    for (int axis = 0; axis < 6; ++axis) {
      const auto cost = [&](double step) {
        Bundle moved = bundle_;
        const Vector6d by = step * Vector6d::Unit(axis);
        Rigid3& pose = *moved.left_from_world[frame];
        pose = {ExpRotation(by.head<3>()) * pose.rotation, pose.translation + by.tail<3>()};
        double sum = 0.0;
        for (const double error : ErrorsPx(moved)) {
          sum += error <= huber_px ? 0.5 * error * error : huber_px * (error - 0.5 * huber_px);
        }
        return sum;
      };
      gradient(axis) = (cost(kStep) - cost(-kStep)) / (2.0 * kStep);
    }
    return gradient;
  }

  SyntheticRover rover_;
  Bundle bundle_;
};

TEST_F(BundleSolverTest, EndsWhereTheLossIsFlat) {
  DisturbSome();
  for (const double huber_px : {kNoLimit_px, 0.6}) {
    const double before = Gradient(4, huber_px).norm();
    const auto summary = BundleSolver(bundle_, huber_px).Solve(1e-14);
    EXPECT_LT(summary.final_cost, summary.initial_cost);
    EXPECT_LT(Gradient(4, huber_px).norm(), 1e-3 * before) << huber_px;
  }
}

TEST_F(BundleSolverTest, CostIsHalfTheSumOfTheLoss) {
  double squares = 0.0;
  for (const double error : ErrorsPx(bundle_)) squares += error * error;
  EXPECT_NEAR(BundleSolver(bundle_, kNoLimit_px).Solve(1e-4).initial_cost, 0.5 * squares,
              1e-9 * squares);
}

TEST_F(BundleSolverTest, NumberOfThreadsChangesNoBit) {
  DisturbSome();
  Bundle alone = bundle_;
  {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    BundleSolver(alone, 0.6).Solve(1e-7);
  }
  const tbb::global_control four(tbb::global_control::max_allowed_parallelism, 4);
  BundleSolver(bundle_, 0.6).Solve(1e-7);
  for (std::size_t i = 0; i < bundle_.left_from_world.size(); ++i) {
    EXPECT_EQ(bundle_.left_from_world[i]->translation, alone.left_from_world[i]->translation);
    EXPECT_EQ(bundle_.left_from_world[i]->rotation.coeffs(),
              alone.left_from_world[i]->rotation.coeffs());
  }
  for (std::size_t p = 0; p < bundle_.points.size(); ++p) {
    EXPECT_EQ(bundle_.points[p].x, alone.points[p].x);
  }
}

TEST_F(BundleSolverTest, LeavesABundleWithAPointBehindAnEye) {
  bundle_.points[3].x = bundle_.left_from_world[0]->Inverse() * Eigen::Vector3d(0.0, 0.0, -5.0);
  const Bundle before = bundle_;
  EXPECT_EQ(BundleSolver(bundle_, 1.0).Solve(1e-7).iterations, 0);
  EXPECT_EQ(bundle_.points[7].x, before.points[7].x);
}

// Frames that share fewer than ten points are held, each by itself.
TEST_F(BundleSolverTest, MovesPointsAloneWhereEveryPoseIsHeld) {
  bundle_.points.resize(5);
  const Bundle before = bundle_;
  const auto summary = BundleSolver(bundle_, kNoLimit_px).Solve(1e-10);
  EXPECT_LE(summary.final_cost, summary.initial_cost);
  EXPECT_NE(bundle_.points[0].x, before.points[0].x);
  for (std::size_t i = 0; i < before.left_from_world.size(); ++i) {
    EXPECT_EQ(bundle_.left_from_world[i]->translation, before.left_from_world[i]->translation);
  }
}

TEST_F(BundleSolverTest, TakesABundleWithoutPoints) {
  bundle_.points.clear();
  EXPECT_EQ(BundleSolver(bundle_, 1.0).Solve(1e-7).final_cost, 0.0);
}

}  // namespace
}  // namespace rigmap
