#include "adjustment/internal/rig_flexure.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>

#include "tests/adjustment/rover_bundle.h"

namespace rigmap {
namespace {

class FlexureTest : public AdjustTest {
 protected:
  FlexureTest() { Make({.frames = 24, .points_per_m2 = 12.0, .pixel_sigma = 0.1, .seed = 75}); }

  // Turns the right eye about its x and y axes, in each frame by other angles, which are returned.
  std::vector<Eigen::Vector3d> Shake(double sigma_px) {
    const Camera& camera = rover_.rig.right.camera;
    std::vector<Eigen::Vector3d> turns;
    for (auto& frame : correspondences_.features) {
      const Eigen::Vector3d turn(random_.Normal(sigma_px / camera.MeanFocal()),
                                 random_.Normal(sigma_px / camera.MeanFocal()), 0.0);
      turns.push_back(turn);
      for (Feature& feature : frame) {
        if (!feature.right) continue;
        const Eigen::Vector3d ray = Undistort(camera, *feature.right).value().homogeneous();
        feature.right = Distort(camera, (ExpRotation(turn) * ray).hnormalized());
      }
    }
    return turns;
  }

  Adjustment Adjusted(const AdjustmentOptions& options = {}) const {
    return Adjust(AllOf(rover_.world_from_left), options);
  }

  double Error_m(const Adjustment& adjusted) const {
    double squares = 0.0;
    for (std::size_t i = 0; i < rover_.world_from_left.size(); ++i) {
      const Vector6d error = ErrorOf(*adjusted.world_from_left[i], rover_.world_from_left[i]);
      squares += error.head<3>().squaredNorm();
    }
    return std::sqrt(squares / static_cast<double>(rover_.world_from_left.size()));
  }

  double NormalisedEndError(const Adjustment& adjusted) const {
    const Eigen::Vector3d error =
        ErrorOf(*adjusted.world_from_left.back(), rover_.world_from_left.back()).head<3>();
    const Eigen::Matrix3d covariance = adjusted.covariances.back().topLeftCorner<3, 3>();
    return error.dot(covariance.ldlt().solve(error)) / 3.0;
  }
};

TEST_F(FlexureTest, ARigThatShakesIsSteadied) {
  const double still_m = Error_m(Adjusted());
  Shake(0.2);
  const Adjustment steadied = Adjusted(), held = Adjusted({.refine_rig = RigRefinement::kNone});
  EXPECT_GT(held.noise_px, 0.13);
  EXPECT_NEAR(steadied.noise_px, 0.1, 0.005) << "what was put in";
  EXPECT_LT(Error_m(steadied), 0.7 * Error_m(held));
  EXPECT_LT(Error_m(steadied), 3.0 * still_m);
}

TEST_F(FlexureTest, TurnsAreThoseThatWerePutIn) {
  EXPECT_TRUE(Adjusted().right_turns.empty());
  const auto put_in = Shake(0.2);
  const Adjustment steadied = Adjusted();
  ASSERT_EQ(steadied.right_turns.size(), put_in.size());
  const Camera& camera = rover_.rig.right.camera;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();  // which the rig itself takes up
  for (std::size_t i = 0; i < put_in.size(); ++i) {
    mean += (put_in[i] - steadied.right_turns[i]) / static_cast<double>(put_in.size());
  }
  double squares = 0.0;
  for (std::size_t i = 0; i < put_in.size(); ++i) {
    squares += (put_in[i] - steadied.right_turns[i] - mean).squaredNorm();
  }
  EXPECT_LT(camera.MeanFocal() * std::sqrt(squares / static_cast<double>(put_in.size())), 0.05);
  const Eigen::Vector3d px = FlexurePx(camera, steadied.right_turns);
  EXPECT_NEAR(px.x(), 0.2, 0.08);
  EXPECT_NEAR(px.y(), 0.2, 0.08);
  EXPECT_EQ(px.z(), 0.0) << "it does not roll";
}

TEST(FlexurePx, IsWhatTurnsDoInTheImage) {
  const Camera camera{600, 450, 500.0, 500.0, 300.0, 225.0};
  EXPECT_EQ(FlexurePx(camera, {}), Eigen::Vector3d::Zero());
  const double turn = 1e-3;
  const Eigen::Vector3d px = FlexurePx(camera, {{turn, 0.0, turn}, {-turn, 0.0, turn}});
  EXPECT_NEAR(px.x(), 0.5, 1e-12);
  EXPECT_EQ(px.y(), 0.0);
  double squares = 0.0;
  for (int row = 0; row < camera.height; ++row) {
    for (int column = 0; column < camera.width; ++column) {
      squares += (Eigen::Vector2d(column, row) - Eigen::Vector2d(299.5, 224.5)).squaredNorm();
    }
  }
  EXPECT_NEAR(px.z(), turn * std::sqrt(squares / (camera.width * camera.height)), 1e-6);
}

TEST_F(FlexureTest, SigmasOfASteadiedRigAreHonest) {
  // 3 x 20 degrees of freedom: by chance within 0.7 and 1.4.
  constexpr int kTrials = 20;
  // The rig is exact in the mean, and said to be.
  const AdjustmentOptions options{.rig_prior_deg = 1e-6,
                                  .focal_prior_pct = 1e-6,
                                  .aspect_prior_pct = 1e-6,
                                  .principal_point_prior_px = 1e-6,
                                  .distortion_prior_px = 1e-6,
                                  .board_noise_px = 1e-6,
                                  .shared_noise = 1.0};
  double sum = 0.0;
  for (unsigned trial = 0; trial < kTrials; ++trial) {
    Make({.frames = 16, .points_per_m2 = 8.0, .pixel_sigma = 0.1, .seed = 200 + trial});
    Shake(0.2);
    sum += NormalisedEndError(Adjusted(options));
  }
  EXPECT_GT(sum / kTrials, 0.5);
  EXPECT_LT(sum / kTrials, 2.0);
}

TEST_F(FlexureTest, WhatStretchesAndRegionsSayAddsUpToTheWhole) {
  Shake(0.2);
  const CalibrationEquations equations = Adjusted().calibration.value();
  for (const auto& blocks : {equations.stretches, equations.regions}) {
    CalibrationBlock sum;
    for (const CalibrationBlock& block : blocks) sum += block;
    EXPECT_LT((sum.information - equations.information).norm(),
              1e-6 * equations.information.norm());
    EXPECT_LT((sum.score - equations.score).norm(), 1e-3 * equations.score.norm());
  }
}

TEST_F(FlexureTest, ARigThatStandsIsLeftAlone) {
  const Adjustment adjusted = Adjusted();
  const MaybePoses left_from_world = InverseOf(adjusted.world_from_left);
  const Linearisation at{adjusted.points, left_from_world, rover_.rig, 0.1, 0.2};
  RigFlexure flexure;
  EXPECT_FALSE(flexure.Begin(at, {}));
  EXPECT_FALSE(flexure.IsFound());
  EXPECT_EQ(flexure.Steadied(rover_.rig.right.camera, 3, {100.5, 200.25}),
            Eigen::Vector2d(100.5, 200.25));
}

TEST_F(FlexureTest, FindsBothAxesThatTurnAndNotTheThird) {
  Shake(0.2);
  const Adjustment adjusted = Adjusted({.refine_rig = RigRefinement::kNone});
  const MaybePoses left_from_world = InverseOf(adjusted.world_from_left);
  const Linearisation at{adjusted.points, left_from_world, rover_.rig, 0.1, 0.2};
  RigFlexure flexure;
  ASSERT_TRUE(flexure.Begin(at, {}));
  const Eigen::Vector3d sigmas_px = rover_.rig.right.camera.MeanFocal() * flexure.Sigmas();
  // Points seen by this frame and a few others move along with it.
  EXPECT_NEAR(sigmas_px.x(), 0.2, 0.08);
  EXPECT_NEAR(sigmas_px.y(), 0.2, 0.08);
  EXPECT_LT(sigmas_px.z(), 0.05);
}

}  // namespace
}  // namespace rigmap
