#include "adjustment/calibration_prior.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "adjustment/calibration.h"
#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

TEST(PriorOf, EachOfTheDistortionMovesThePixelInTheCornerAlike) {
  const StereoRig rig = LocCamRig();
  const AdjustmentOptions options{.board_noise_px = 1e-6};
  const CalibrationVector prior = PriorOf(rig, options).sigmas;
  const Camera& camera = rig.left.camera;
  Camera plain = camera;
  plain.k1 = plain.k2 = plain.p1 = plain.p2 = 0.0;
  // As far from the principal point as half a diagonal, where a tangential term is largest.
  const double corner = 0.5 * std::hypot(camera.width, camera.height) / camera.MeanFocal();
  for (int i = 0; i < 4; ++i) {
    Camera bent = plain;
    bent.k1 += i == 0 ? prior(kLeftK1) : 0.0;
    bent.k2 += i == 1 ? prior(kLeftK2) : 0.0;
    bent.p1 += i == 2 ? prior(kLeftP1) : 0.0;
    bent.p2 += i == 3 ? prior(kLeftP2) : 0.0;
    const Eigen::Vector2d at = i == 2 ? Eigen::Vector2d(0.0, corner) : Eigen::Vector2d(corner, 0.0);
    EXPECT_NEAR((Distort(bent, at) - Distort(plain, at)).norm(), options.distortion_prior_px,
                0.02 * options.distortion_prior_px);
  }
}

TEST(PriorOf, ARigFileThatStatesItsCovarianceIsTakenAtItsWord) {
  StereoRig rig = LocCamRig();
  CalibrationMatrix covariance = CalibrationMatrix::Identity();
  covariance(kRotationY, kLeftCx) = covariance(kLeftCx, kRotationY) = 0.5;
  rig.calibration_covariance = covariance;
  const CalibrationPrior prior = PriorOf(rig, {});
  EXPECT_EQ(prior.sigmas, CalibrationVector::Ones());
  EXPECT_TRUE((prior.information * covariance).isIdentity(1e-9));
}

// A Bumblebee2 of 640 x 480 px as two calibrations made it, with a chessboard and with a grid of
// squares, from some ten views each: Peter Abeles, BoofCV-Data, example/calibration/stereo.
Camera Bumblebee2Eye(double fx, double fy, double cx, double cy, double k1, double k2) {
  return {.width = 640, .height = 480, .fx = fx, .fy = fy, .cx = cx, .cy = cy, .k1 = k1, .k2 = k2};
}

StereoRig Bumblebee2(const Camera& left, const Camera& right,
                     const Eigen::Matrix3d& left_from_right, const Eigen::Vector3d& right_in_left) {
  StereoRig rig = LocCamRig();
  rig.left.camera = left;
  rig.right.camera = right;
  rig.right_from_left =
      Rigid3{Eigen::Quaterniond(left_from_right).normalized(), right_in_left}.Inverse();
  return rig;
}

TEST(PriorOf, HoldsByWhatTwoCalibrationsOfOneRigDiffer) {
  Eigen::Matrix3d left_from_right;
  left_from_right << 0.99996948, -0.00216766, 0.00750659, 0.00214476, 0.99999299, 0.00305711,
      -0.00751317, -0.00304091, 0.99996715;
  const StereoRig chessboard =
      Bumblebee2(Bumblebee2Eye(524.614, 526.920, 312.451, 247.402, -0.362537, 0.175328),
                 Bumblebee2Eye(526.438, 528.652, 318.404, 245.935, -0.353000, 0.162974),
                 left_from_right, {0.1200437, 0.0008974, -0.0009150});
  left_from_right << 0.99999786, -0.00140655, 0.00151922, 0.00139254, 0.99995684, 0.00918556,
      -0.00153207, -0.00918342, 0.99995666;
  const StereoRig squares =
      Bumblebee2(Bumblebee2Eye(528.877, 530.847, 315.085, 246.360, -0.372544, 0.187051),
                 Bumblebee2Eye(530.921, 532.328, 317.244, 248.825, -0.355781, 0.146394),
                 left_from_right, {0.1195070, 0.0014041, -0.0002421});
  const CalibrationVector differ = CorrectionBetween(chessboard, squares);
  // Over two variances, as both are off, and over the 15 parameters that both estimated: no p1, p2.
  const auto squared = [&](const AdjustmentOptions& options) {
    const CalibrationMatrix information = PriorOf(chessboard, options).information;
    return 0.5 * differ.dot(information * differ) / 15.0;
  };
  EXPECT_LT(squared({}), 1.67);  // 95 % of chi-square
  EXPECT_GT(squared({.board_noise_px = 1e-6}), 2.5 * squared({}));
}

class Board : public testing::Test {
 protected:
  // Where the right eye sees, after a correction, what the left one sees at `pixel` at a depth.
  static Eigen::Vector2d RightPixel(const StereoRig& rig, const Eigen::Vector2d& pixel,
                                    double depth_m) {
    const Eigen::Vector2d ray = Undistort(rig.left.camera, pixel).value();
    return Project(rig.right.camera, rig.right_from_left * (depth_m * ray.homogeneous())).value();
  }

  // Largest move of these pixels, over what a board of half the image's height shows in the middle
  // and half-way to the edges, at the depths it stands at.
  double MovesPx(const CalibrationVector& correction) const {
    const StereoRig corrected = Corrected(rig_, correction);
    const Camera& camera = rig_.left.camera;
    double moved_px = 0.0;
    for (const double x : {0.25, 0.5, 0.75}) {
      for (const double y : {0.25, 0.5, 0.75}) {
        for (const double depth_m : {0.5, 1.0}) {
          const Eigen::Vector2d pixel(x * camera.width, y * camera.height);
          moved_px = std::max(
              moved_px,
              (RightPixel(corrected, pixel, depth_m) - RightPixel(rig_, pixel, depth_m)).norm());
        }
      }
    }
    return moved_px;
  }

  StereoRig rig_ = LocCamRig();
  const CalibrationVector alone_ = PriorOf(rig_, {.board_noise_px = 1e-6}).sigmas;
  const CalibrationMatrix covariance_ = BoardCovariance(rig_, alone_);
};

TEST_F(Board, LeavesTheTurnOfTheRightEyeAndWhatMakesUpForIt) {
  const CalibrationVector sigmas = covariance_.diagonal().cwiseSqrt();
  EXPECT_GT(sigmas(kRotationY), 0.05 * std::numbers::pi / 180.0);
  const CalibrationVector together = covariance_.col(kRotationY) / sigmas(kRotationY);
  const CalibrationVector turn = sigmas(kRotationY) * CalibrationVector::Unit(kRotationY);
  EXPECT_GT(MovesPx(turn), 1.0);
  EXPECT_LT(MovesPx(together), 0.4 * MovesPx(turn));
}

TEST_F(Board, TellsTheDisparityAtInfinity) {
  const double by_board =
      SigmaOf(DisparityAtInfinity, rig_, CalibrationVector::Zero(), alone_, covariance_);
  const CalibrationMatrix unrelated = covariance_.diagonal().asDiagonal();
  EXPECT_LT(by_board, 0.3);
  EXPECT_GT(SigmaOf(DisparityAtInfinity, rig_, CalibrationVector::Zero(), alone_, unrelated),
            5.0 * by_board);
}

TEST_F(Board, SaysNothingOfTheCommonFocalLength) {
  EXPECT_NEAR(covariance_.row(kLogFocal).cwiseAbs().maxCoeff(), 0.0, 1e-12);
  const CalibrationPrior prior = PriorOf(rig_, {});
  EXPECT_NEAR(prior.sigmas(kLogFocal), 0.005, 1e-9);
}

TEST_F(Board, LeavesNoParameterBeyondTenTimesItsSigmaAlone) {
  const CalibrationVector sigmas = covariance_.diagonal().cwiseSqrt();
  EXPECT_LE(sigmas.cwiseQuotient(alone_).maxCoeff(), 10.0);
  // Of a narrow image k2 tells next to nothing.
  StereoRig narrow = rig_;
  for (RigEye* eye : {&narrow.left, &narrow.right}) {
    eye->camera.fx *= 5.0;
    eye->camera.fy *= 5.0;
  }
  const CalibrationVector wide = PriorOf(narrow, {.board_noise_px = 1e-6}).sigmas;
  const CalibrationMatrix covariance = BoardCovariance(narrow, wide);
  EXPECT_TRUE(covariance.allFinite());
  EXPECT_GT(std::sqrt(covariance(kLeftK2, kLeftK2)) / wide(kLeftK2),
            sigmas(kLeftK2) / alone_(kLeftK2));
  EXPECT_LE(std::sqrt(covariance(kLeftK2, kLeftK2)), 10.0 * wide(kLeftK2));
}

TEST_F(Board, OfAFileThatStatesSigmasTheseCount) {
  StereoRig stated = rig_;
  stated.stated_sigmas = {.rotation_deg = 0.02, .focal_pct = 0.1, .board_px = 1e-6};
  const CalibrationPrior prior = PriorOf(stated, {});
  EXPECT_NEAR(prior.sigmas(kLogFocal), 0.001, 1e-9);
  EXPECT_NEAR(prior.sigmas(kRotationY), 0.02 * std::numbers::pi / 180.0, 1e-9);
  EXPECT_NEAR(prior.sigmas(kLeftCx), AdjustmentOptions().principal_point_prior_px, 1e-6);
}

TEST_F(Board, PixelsKeepASigmaOfTheirOwn) {
  const AdjustmentOptions options{.board_noise_px = 1e-6};
  const auto sigma = [&](const StereoRig& rig, CalibrationParameter parameter) {
    return PriorOf(rig, options).sigmas(parameter);
  };
  StereoRig rig = rig_;
  EXPECT_NEAR(sigma(rig, kLogAspect), 0.001, 1e-9);
  EXPECT_NEAR(sigma(rig, kLogRightAspect), 0.001, 1e-9);
  rig.stated_sigmas.aspect_pct = 0.2;
  EXPECT_NEAR(sigma(rig, kLogAspect), 0.002, 1e-9);
  EXPECT_NEAR(sigma(rig, kLogRightAspect), 0.002, 1e-9);
}

TEST_F(Board, AndEachParameterAloneMakeAPrior) {
  const CalibrationPrior prior = PriorOf(rig_, {.board_noise_px = 1.0});
  const CalibrationMatrix expected =
      covariance_ + CalibrationMatrix(alone_.cwiseAbs2().asDiagonal());
  EXPECT_TRUE((prior.information * expected).isIdentity(1e-6));
  EXPECT_TRUE(prior.sigmas.isApprox(expected.diagonal().cwiseSqrt(), 1e-6));
  // Twice the noise, four times the board's share.
  const CalibrationMatrix noisier = PriorOf(rig_, {.board_noise_px = 2.0}).information.inverse();
  EXPECT_TRUE((noisier - expected).isApprox(3.0 * covariance_, 1e-6));
}

}  // namespace
}  // namespace rigmap
