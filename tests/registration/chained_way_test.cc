#include "registration/internal/chained_way.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "geometry/rigid3.h"

namespace rigmap {
namespace {

Rigid3 Step(double along_m, double turn_rad) {
  Rigid3 step;
  step.rotation = ExpRotation(turn_rad * Eigen::Vector3d(0.1, 1.0, -0.2));
  step.translation = {0.02, -0.01, -along_m};
  return step;
}

// frame_from_reference of each frame but the first.
struct Chain {
  std::vector<int> references;
  std::vector<Rigid3> steps;

  Odometry Motion(const std::vector<Matrix6d>& covariances) const {
    Odometry motion(1);
    for (std::size_t i = 0; i < steps.size(); ++i) {
      const Rigid3& before = motion[references[i]].world_from_left;
      motion.push_back({.world_from_left = before * steps[i].Inverse(),
                        .reference = references[i],
                        .step_covariance = covariances[i]});
    }
    return motion;
  }
};

// Frames 2 and 3 hang on frame 1, frame 4 on frame 2.
Chain Branched() {
  return {{0, 1, 1, 2}, {Step(0.4, 0.1), Step(0.5, -0.3), Step(0.9, 0.5), Step(0.6, 0.2)}};
}

Matrix6d DiagonalOf(double along_m, double turn_rad) {
  Vector6d sigmas;
  sigmas << along_m, 2.0 * along_m, 3.0 * along_m, turn_rad, 0.5 * turn_rad, 2.0 * turn_rad;
  return sigmas.cwiseAbs2().asDiagonal();
}

std::vector<Matrix6d> Covariances() {
  return {DiagonalOf(0.05, 0.1), DiagonalOf(0.001, 0.003), DiagonalOf(0.002, 0.001),
          DiagonalOf(0.001, 0.002)};
}

Matrix6d Drawn(const Chain& chain, const std::vector<Matrix6d>& covariances, int earlier,
               int later) {
  constexpr int kDraws = 20000;
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const Rigid3 expected = OdometricStep(chain.Motion(covariances), later, earlier);
  Matrix6d sum = Matrix6d::Zero();
  for (int draw = 0; draw < kDraws; ++draw) {
    Chain moved = chain;
    for (std::size_t i = 0; i < moved.steps.size(); ++i) {
      Vector6d error;
      for (int k = 0; k < 6; ++k) error(k) = std::sqrt(covariances[i](k, k)) * normal(random);
      moved.steps[i] = Rigid3{ExpRotation(error.tail<3>()), error.head<3>()} * moved.steps[i];
    }
    const Rigid3 off =
        OdometricStep(moved.Motion(covariances), later, earlier) * expected.Inverse();
    Vector6d difference;
    difference << off.translation, LogRotation(off.rotation);
    sum += difference * difference.transpose();
  }
  return sum / kDraws;
}

TEST(CovarianceBetween, IsThatOfDrawnChains) {
  const Chain chain = Branched();
  const std::vector<Matrix6d> covariances = Covariances();
  for (const auto& [earlier, later] : {std::pair{2, 3}, {3, 4}, {1, 4}, {2, 4}}) {
    const auto found = CovarianceBetween(chain.Motion(covariances), earlier, later);
    ASSERT_TRUE(found);
    const Matrix6d drawn = Drawn(chain, covariances, earlier, later);
    // Each entry beside the sigmas of its two coordinates.
    const Vector6d sigmas = drawn.diagonal().cwiseSqrt();
    const Matrix6d off = (*found - drawn).cwiseQuotient(sigmas * sigmas.transpose());
    EXPECT_LT(off.cwiseAbs().maxCoeff(), 0.05) << earlier << ", " << later;
  }
}

TEST(CovarianceBetween, LeavesOutWhatBothFramesHangOn) {
  const Chain chain = Branched();
  std::vector<Matrix6d> covariances = Covariances();
  const auto found = CovarianceBetween(chain.Motion(covariances), 2, 3);
  covariances[0] *= 100.0;
  EXPECT_EQ(*found, *CovarianceBetween(chain.Motion(covariances), 2, 3));
}

TEST(CovarianceBetween, IsUnknownWhereFramesHangOnNothingInCommon) {
  Odometry motion = Branched().Motion(Covariances());
  motion[2].reference = 2;
  EXPECT_TRUE(CovarianceBetween(motion, 1, 3));
  EXPECT_FALSE(CovarianceBetween(motion, 3, 4));
}

}  // namespace
}  // namespace rigmap
