#include "adjustment/calibration_prior.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "adjustment/calibration.h"

namespace rigmap {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

CalibrationVector SigmasOf(const StereoRig& rig, const AdjustmentOptions& options) {
  CalibrationVector sigmas;
  sigmas.segment<3>(kRotationX).setConstant(options.rig_prior_deg * kDegree);
  sigmas.segment<2>(kLogFocal).setConstant(options.focal_prior_pct / 100.0);
  sigmas.segment<2>(kLogAspect).setConstant(options.aspect_prior_pct / 100.0);
  sigmas.segment<4>(kLeftCx).setConstant(options.principal_point_prior_px);
  for (const Eye eye : {Eye::kLeft, Eye::kRight}) {
    const Camera& camera = rig.Of(eye).camera;
    const double focal = camera.MeanFocal(),
                 corner = 0.5 * std::hypot(camera.width, camera.height) / focal;
    // Of the polynomial's terms: k1 r^3, k2 r^5, and 3 p r^2 where a tangential one is largest.
    sigmas.segment<4>(eye == Eye::kLeft ? kLeftK1 : kRightK1) << std::pow(corner, -3.0),
        std::pow(corner, -5.0), std::pow(corner, -2.0) / 3.0, std::pow(corner, -2.0) / 3.0;
    sigmas.segment<4>(eye == Eye::kLeft ? kLeftK1 : kRightK1) *=
        options.distortion_prior_px / focal;
  }
  return sigmas;
}

AdjustmentOptions WithStated(AdjustmentOptions options, const RigSigmas& stated) {
  options.rig_prior_deg = stated.rotation_deg.value_or(options.rig_prior_deg);
  options.focal_prior_pct = stated.focal_pct.value_or(options.focal_prior_pct);
  options.aspect_prior_pct = stated.aspect_pct.value_or(options.aspect_prior_pct);
  options.principal_point_prior_px =
      stated.principal_point_px.value_or(options.principal_point_prior_px);
  options.distortion_prior_px = stated.distortion_px.value_or(options.distortion_prior_px);
  options.board_noise_px = stated.board_px.value_or(options.board_noise_px);
  return options;
}

constexpr int kCornersPerSide = 7, kCorners = kCornersPerSide * kCornersPerSide;
constexpr double kFilled = 0.5;  // of the image's height, by the nearer board
constexpr double kAside = 0.25;  // of the image's size, from its middle
constexpr double kTilt = 30.0 * kDegree;
constexpr double kParallax = 0.25;  // of the image's width, of the nearer board in the other eye
constexpr double kMinBaselines = 4.0;

// What a view has unknown: the rig's 19 parameters, the baseline's translation, the board's pose.
constexpr int kTranslation = kCalibrationSize, kRigSize = kTranslation + 3,
              kUnknowns = kRigSize + 6;
using ViewUnknowns = Eigen::Matrix<double, kUnknowns, 1>;
using ViewPixels = Eigen::Matrix<double, 4 * kCorners, 1>;
using RigMatrix = Eigen::Matrix<double, kRigSize, kRigSize>;

struct BoardView {
  Rigid3 left_from_board;
  double side_m = 0.0;

  ViewPixels Pixels(const StereoRig& rig, const ViewUnknowns& off) const {
    StereoRig seen_by = Corrected(rig, off.head<kCalibrationSize>());
    seen_by.right_from_left.translation += off.segment<3>(kTranslation);
    const Rigid3 moved{ExpRotation(off.segment<3>(kRigSize)), off.tail<3>()};
    ViewPixels pixels;
    for (int i = 0; i < kCorners; ++i) {
      const Eigen::Vector3d corner =
          side_m * Eigen::Vector3d((i % kCornersPerSide) / (kCornersPerSide - 1.0) - 0.5,
                                   (i / kCornersPerSide) / (kCornersPerSide - 1.0) - 0.5, 0.0);
      const Eigen::Vector3d in_left = left_from_board * (moved * corner);
      const Eigen::Vector3d in_right = seen_by.right_from_left * in_left;
      pixels.segment<2>(4 * i) = Distort(seen_by.left.camera, in_left.hnormalized());
      pixels.segment<2>(4 * i + 2) = Distort(seen_by.right.camera, in_right.hnormalized());
    }
    return pixels;
  }
};

std::vector<BoardView> ViewsOf(const StereoRig& rig) {
  const Camera& camera = rig.left.camera;
  const double focal = camera.MeanFocal();
  const double near_m =
      rig.Baseline() * std::max(kMinBaselines, focal / (kParallax * camera.width));
  constexpr std::array<std::array<int, 2>, 5> kFive = {
      {{0, 0}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}}};
  constexpr std::array<std::array<int, 2>, 5> kTilts = {{{0, 0}, {1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
  std::vector<BoardView> views;
  for (const auto& [x, y] : kFive) {
    for (const auto& [about_x, about_y] : kTilts) {
      const double depth_m = near_m * (views.size() % 2 == 0 ? 1.0 : 2.0);
      views.push_back({{ExpRotation(kTilt * Eigen::Vector3d(about_x, about_y, 0.0)),
                        depth_m * Eigen::Vector3d(kAside * x * camera.width / focal,
                                                  kAside * y * camera.height / focal, 1.0)},
                       kFilled * camera.height / focal * depth_m});
    }
  }
  return views;
}

// Normal equations of one view once the board's pose is eliminated.
RigMatrix InformationOf(const BoardView& view, const StereoRig& rig, const ViewUnknowns& steps) {
  Eigen::Matrix<double, 4 * kCorners, kUnknowns> jacobian;
  for (int i = 0; i < kUnknowns; ++i) {
    const ViewUnknowns step = steps(i) * ViewUnknowns::Unit(i);
    jacobian.col(i) = (view.Pixels(rig, step) - view.Pixels(rig, -step)) / (2.0 * steps(i));
  }
  const Eigen::Matrix<double, kUnknowns, kUnknowns> normal = jacobian.transpose() * jacobian;
  const Eigen::Matrix<double, kRigSize, 6> coupling = normal.topRightCorner<kRigSize, 6>();
  const Eigen::Matrix<double, 6, 6> pose = normal.bottomRightCorner<6, 6>();
  return normal.topLeftCorner<kRigSize, kRigSize>() -
         coupling * pose.ldlt().solve(coupling.transpose());
}

}  // namespace

CalibrationMatrix BoardCovariance(const StereoRig& rig, const CalibrationVector& alone) {
  constexpr double kStep = 0.01, kStepRad = 1e-5, kStepShare = 1e-5;  // where all is linear
  constexpr double kWidest = 10.0;
  RigMatrix information = RigMatrix::Zero();
  information.diagonal().head<kCalibrationSize>() = (kWidest * alone).cwiseAbs2().cwiseInverse();
  for (const BoardView& view : ViewsOf(rig)) {
    ViewUnknowns steps;
    steps << kStep * alone, Eigen::Vector3d::Constant(kStepShare * rig.Baseline()),
        Eigen::Vector3d::Constant(kStepRad), Eigen::Vector3d::Constant(kStepShare * view.side_m);
    information += InformationOf(view, rig, steps);
  }
  const CalibrationMatrix covariance =
      information.inverse().topLeftCorner<kCalibrationSize, kCalibrationSize>();
  const CalibrationVector with_focal = covariance.col(kLogFocal);
  return covariance - with_focal * with_focal.transpose() / with_focal(kLogFocal);
}

CalibrationPrior PriorOf(const StereoRig& rig, const AdjustmentOptions& usual) {
  const AdjustmentOptions options = WithStated(usual, rig.stated_sigmas);
  CalibrationMatrix covariance;
  if (rig.calibration_covariance) {
    covariance = *rig.calibration_covariance;
  } else {
    const CalibrationVector alone = SigmasOf(rig, options);
    covariance = options.board_noise_px * options.board_noise_px * BoardCovariance(rig, alone);
    covariance.diagonal() += alone.cwiseAbs2();
  }
  return {covariance.diagonal().cwiseSqrt(), covariance.inverse()};
}

}  // namespace rigmap
