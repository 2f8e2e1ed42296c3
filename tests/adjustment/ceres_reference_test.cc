// The room's solver beside Ceres, with derivatives by differences.
#include <ceres/ceres.h>
#include <gtest/gtest.h>

#include "adjustment/internal/bundle_solver.h"
#include "adjustment/internal/datum_frames.h"
#include "tests/adjustment/rover_bundle.h"

namespace rigmap {
namespace {

Rigid3 MovedBy(const Rigid3& pose, const double* turn_and_shift) {
  return {ExpRotation(Eigen::Map<const Eigen::Vector3d>(turn_and_shift)) * pose.rotation,
          pose.translation + Eigen::Map<const Eigen::Vector3d>(turn_and_shift + 3)};
}

// Of a pose that is moved from where it starts.
struct ReprojectionError {
  const StereoRig& rig;
  Rigid3 start;
  PointObservation observation;

  bool operator()(const double* turn_and_shift, const double* point, double* residual) const {
    const Eigen::Vector3d in_left =
        MovedBy(start, turn_and_shift) * Eigen::Vector3d(Eigen::Map<const Eigen::Vector3d>(point));
    const auto pixel = observation.eye == Eye::kLeft
                           ? Project(rig.left.camera, in_left)
                           : Project(rig.right.camera, rig.right_from_left * in_left);
    if (!pixel) return false;
    Eigen::Map<Eigen::Vector2d>{residual} = *pixel - observation.pixel;
    return true;
  }
};

// Moves the bundle to where Ceres sees the least cost; returns that.
double SolveByCeres(double huber_px, Bundle& bundle) {
  ceres::Problem problem;
  std::vector<std::array<double, 6>> moves(bundle.left_from_world.size(), {0, 0, 0, 0, 0, 0});
  for (AdjustedPoint& point : bundle.points) {
    for (const PointObservation& observation : point.observations) {
      using Cost = ceres::NumericDiffCostFunction<ReprojectionError, ceres::CENTRAL, 2, 6, 3>;
      problem.AddResidualBlock(
          new Cost(new ReprojectionError{bundle.rig, *bundle.left_from_world[observation.frame],
                                         observation}),
          new ceres::HuberLoss(huber_px), moves[observation.frame].data(), point.x.data());
    }
  }
  const std::vector<int> datum_frames = DatumFrames(bundle.points, moves.size());
  for (std::size_t i = 0; i < moves.size(); ++i) {
    if (datum_frames[i] == static_cast<int>(i)) problem.SetParameterBlockConstant(moves[i].data());
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_SCHUR;
  options.function_tolerance = 1e-12;
  options.max_num_iterations = 100;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  for (std::size_t i = 0; i < moves.size(); ++i) {
    bundle.left_from_world[i] = MovedBy(*bundle.left_from_world[i], moves[i].data());
  }
  return summary.final_cost;
}

TEST(BundleSolver, EndsWhereCeresDoes) {
  const SyntheticRover rover =
      MakeSyntheticRover({.frames = 6, .points_per_m2 = 8.0, .pixel_sigma = 0.3, .seed = 24});
  const Correspondences correspondences = RoverCorrespondences(rover, 4);
  Bundle ours{rover.rig, InverseOf(AllOf(rover.world_from_left)), {}};
  ours.points = TriangulateTracks(BuildTracks(correspondences, false), correspondences, rover.rig,
                                  ours.left_from_world, 8.0, 100.0);
  for (std::size_t i = 0; i < ours.points.size(); i += 7) {
    ours.points[i].observations.front().pixel += Eigen::Vector2d(3.0, -2.0);
  }
  Bundle theirs = ours;
  constexpr double kHuber_px = 0.6;
  const double cost = SolveByCeres(kHuber_px, theirs);
  const auto summary = BundleSolver(ours, kHuber_px).Solve(1e-12);
  EXPECT_NEAR(summary.final_cost / cost, 1.0, 1e-7);
  EXPECT_LT(summary.final_cost, 0.99 * summary.initial_cost);
  for (std::size_t i = 0; i < ours.left_from_world.size(); ++i) {
    const Rigid3 apart = *ours.left_from_world[i] * theirs.left_from_world[i]->Inverse();
    EXPECT_LT(apart.translation.norm(), 2e-6) << "metres, frame " << i;
    EXPECT_LT(LogRotation(apart.rotation).norm(), 1e-6) << "frame " << i;
  }
}

}  // namespace
}  // namespace rigmap
