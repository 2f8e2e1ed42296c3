#include "adjustment/internal/drift_effect.h"

#include <gmock/gmock.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "adjustment/calibration_prior.h"
#include "adjustment/internal/bundle.h"
#include "adjustment/internal/camera_system.h"
#include "adjustment/reprojection.h"
#include "tests/adjustment/rover_bundle.h"
#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

constexpr double kNoise_px = 0.05, kNoHuberAtAll_px = 1e9, kDrift_px = 0.7;

// Of a point from the left eye of a frame, in world axes.
Eigen::Vector3d RayTo(const Eigen::Vector3d& x, const Rigid3& left_from_world) {
  return x - left_from_world.Inverse().translation;
}

// The angle and the logarithm of distances, by other formulas than the program's.
double DepartureOf(const Eigen::Vector3d& first, const Eigen::Vector3d& ray) {
  const double angle = std::acos(std::min(1.0, first.normalized().dot(ray.normalized())));
  const double nearer = std::log(first.norm()) - std::log(ray.norm());
  return std::sqrt(angle * angle + nearer * nearer);
}

class DriftEffectTest : public testing::Test {
 protected:
  void Make(SyntheticRoverOptions options) {
    options.pixel_sigma = 0.0;
    rover_ = MakeSyntheticRover(options);
    const Correspondences correspondences = RoverCorrespondences(rover_, 3);
    bundle_ = {.rig = rover_.rig, .left_from_world = InverseOf(AllOf(rover_.world_from_left))};
    bundle_.points = TriangulateTracks(BuildTracks(correspondences, false), correspondences,
                                       rover_.rig, bundle_.left_from_world, 8.0, 100.0);
  }

  double DepartureIn(const AdjustedPoint& point, const PointObservation& o) const {
    const int first = point.observations.front().frame;
    if (o.frame == first) return 0.0;
    return DepartureOf(RayTo(point.x, *bundle_.left_from_world[first]),
                       RayTo(point.x, *bundle_.left_from_world[o.frame]));
  }

  // Moves all pixels by noise, and the windows of each point by its drift.
  void Disturb(double drift_px) {
    const auto both = [&](double sigma) -> Eigen::Vector2d {
      return random_.Noise(sigma).head<2>();
    };
    for (AdjustedPoint& point : bundle_.points) {
      const Eigen::Vector2d drift = both(drift_px);
      for (PointObservation& o : point.observations) {
        o.pixel += DepartureIn(point, o) * drift + both(kNoise_px);
      }
    }
  }

  Linearisation At() const {
    return {bundle_.points, bundle_.left_from_world, bundle_.rig, kNoise_px, kNoHuberAtAll_px};
  }

  // The calibration held.
  DriftEffect Effect() const {
    const auto system = SolveCameraSystem(At());
    EXPECT_TRUE(system.calibration);
    return EffectOfDrift(At(), *system.calibration, RigRefinement::kNone, CalibrationVector::Zero(),
                         PriorOf(rover_.rig, {}), {});
  }

  SyntheticRover rover_;
  Bundle bundle_;
  SeededRandom random_;
};

TEST_F(DriftEffectTest, IsTheStepOfTheWholeSystem) {
  Make({.frames = 5, .points_per_m2 = 1.5, .seed = 51});
  Disturb(kDrift_px);
  ASSERT_GT(bundle_.points.size(), 25u);
  const int poses = 6 * 4, size = poses + 5 * static_cast<int>(bundle_.points.size());
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(size);
  for (std::size_t i = 0; i < bundle_.points.size(); ++i) {
    const AdjustedPoint& point = bundle_.points[i];
    const int first = poses + 5 * static_cast<int>(i);
    for (const PointObservation& o : point.observations) {
      const auto at = Reproject(rover_.rig, o.eye, *bundle_.left_from_world[o.frame], point.x);
      Eigen::MatrixXd row = Eigen::MatrixXd::Zero(2, size);
      if (o.frame > 0) row.middleCols<6>(6 * (o.frame - 1)) = at->jacobians.pose;
      row.middleCols<3>(first) = at->jacobians.point;
      row.middleCols<2>(first + 3) = DepartureIn(point, o) * Eigen::Matrix2d::Identity();
      normal += row.transpose() * row / (kNoise_px * kNoise_px);
      gradient += row.transpose() * (at->pixel - o.pixel) / (kNoise_px * kNoise_px);
    }
    normal.diagonal().segment<2>(first + 3).array() += 1.0 / (kDrift_px * kDrift_px);
  }
  const Eigen::VectorXd step = -normal.ldlt().solve(gradient);
  const DriftEffect effect = Effect();
  ASSERT_EQ(effect.poses.size(), 5u);
  EXPECT_TRUE(effect.calibration.isZero());
  EXPECT_TRUE(effect.poses[0].isZero());
  for (int frame = 1; frame < 5; ++frame) {
    const Rigid3& before = *bundle_.left_from_world[frame];
    const auto by = step.segment<6>(6 * (frame - 1));
    const Rigid3 after{ExpRotation(by.head<3>()) * before.rotation,
                       before.translation + by.tail<3>()};
    Vector6d expected;
    expected << after.Inverse().translation - before.Inverse().translation,
        LogRotation(after.Inverse().rotation * before.rotation);
    EXPECT_GT(expected.norm(), 1e-5);
    EXPECT_LT((effect.poses[frame] - expected).norm(), 1e-3 * expected.norm()) << frame;
  }
}

TEST_F(DriftEffectTest, IsNothingWhereNothingIsOff) {
  Make({.frames = 5, .points_per_m2 = 1.5, .seed = 51});
  const DriftEffect effect = Effect();
  EXPECT_LT(std::abs(effect.scale), 1e-9);
  for (const Vector6d& pose : effect.poses) EXPECT_LT(pose.norm(), 1e-9);
}

TEST_F(DriftEffectTest, MovesPosesTowardsTheTruthWhereWindowsDrift) {
  double before = 0.0, after = 0.0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    Make({.frames = 8, .points_per_m2 = 2.0, .seed = 50 + seed});
    Disturb(3.0 * kDrift_px);
    SolveBundle(kNoHuberAtAll_px, kFineTolerance, bundle_);
    const DriftEffect effect = Effect();
    for (int frame = 1; frame < 8; ++frame) {
      const Eigen::Vector3d off = bundle_.left_from_world[frame]->Inverse().translation -
                                  rover_.world_from_left[frame].translation;
      before += off.squaredNorm();
      after += (off + effect.poses[frame].head<3>()).squaredNorm();
    }
  }
  EXPECT_GT(before, 1e-6);
  EXPECT_LT(after, 0.7 * before);
}

TEST_F(DriftEffectTest, ScaleIsThatOfThePositions) {
  Make({.frames = 8, .points_per_m2 = 2.0, .seed = 52});
  Disturb(kDrift_px);
  const DriftEffect effect = Effect();
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& pose : bundle_.left_from_world) mean += pose->Inverse().translation / 8.0;
  double squares = 0.0, products = 0.0;
  for (int frame = 0; frame < 8; ++frame) {
    const Eigen::Vector3d arm = bundle_.left_from_world[frame]->Inverse().translation - mean;
    squares += arm.squaredNorm();
    products += arm.dot(effect.poses[frame].head<3>());
  }
  EXPECT_NE(effect.scale, 0.0);
  EXPECT_NEAR(effect.scale, products / squares, 1e-12);
}

}  // namespace
}  // namespace rigmap
