#include "adjustment/calibration.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace rigmap {
namespace {

CalibrationVector PriorSigmas(const AdjustmentOptions& options) {
  CalibrationVector sigmas;
  sigmas.segment<3>(kRotationX).setConstant(options.rig_prior_deg * std::numbers::pi / 180.0);
  sigmas.segment<2>(kLogFocal).setConstant(options.focal_prior_pct / 100.0);
  sigmas.segment<4>(kLeftCx).setConstant(options.principal_point_prior_px);
  sigmas.segment<2>(kLeftK1).setConstant(options.distortion_prior);
  return sigmas;
}

// Whether a parameter, all others held, moves by more than so many of its sigmas, and by enough to
// matter: over long paths the least noise that all frames share becomes significant.
bool Contradicts(const CalibrationEquations& equations, const AdjustmentOptions& options) {
  constexpr double kMattersPriorSigmas = 0.05;  // 0.005 degrees, 0.025 %, 0.05 px
  const double sigmas = options.refine_sigmas * options.shared_noise;
  const CalibrationVector prior = PriorSigmas(options);
  for (int i = 0; i < kCalibrationSize; ++i) {
    const double variance = std::max(equations.score_covariance(i, i), equations.information(i, i));
    const bool is_sure = equations.score(i) * equations.score(i) > sigmas * sigmas * variance;
    const double step = equations.score(i) / equations.information(i, i);
    if (is_sure && std::abs(step) > kMattersPriorSigmas * prior(i)) return true;
  }
  return false;
}

// How many times as uncertain as independent observations would leave it (variance).
double Inflation(const CalibrationEquations& equations) {
  const CalibrationMatrix ratio = equations.information.ldlt().solve(equations.score_covariance);
  const double mean = ratio.diagonal().mean();
  return std::isfinite(mean) ? std::max(1.0, mean) : 1.0;
}

// The parameters from `first_held` on leave the system.
void Hold(int first_held, CalibrationMatrix& system, CalibrationVector& right_side) {
  for (int i = first_held; i < kCalibrationSize; ++i) {
    system.row(i).setZero();
    system.col(i).setZero();
    system(i, i) = 1.0;
    right_side(i) = 0.0;
  }
}

int FirstHeld(RigRefinement refine_rig) {
  if (refine_rig == RigRefinement::kRotation) return kLogFocal;
  if (refine_rig == RigRefinement::kRotationAndFocal) return kLogRightFocal;
  return kCalibrationSize;
}

}  // namespace

StereoRig Corrected(const StereoRig& rig, const CalibrationVector& correction) {
  StereoRig corrected = rig;
  corrected.right_from_left =
      Rigid3{ExpRotation(correction.segment<3>(kRotationX)), Eigen::Vector3d::Zero()} *
      rig.right_from_left;
  const auto correct = [&](Camera& camera, double log_focal, int centre, int k1) {
    camera.fx *= std::exp(log_focal);
    camera.fy *= std::exp(log_focal);
    camera.cx += correction(centre);
    camera.cy += correction(centre + 1);
    camera.k1 += correction(k1);
  };
  correct(corrected.left.camera, correction(kLogFocal), kLeftCx, kLeftK1);
  correct(corrected.right.camera, correction(kLogFocal) + correction(kLogRightFocal), kRightCx,
          kRightK1);
  return corrected;
}

std::optional<CalibrationStep> RotationAndFocalStep(const CalibrationEquations& equations) {
  const Eigen::Matrix4d information = equations.information.topLeftCorner<4, 4>();
  const Eigen::LDLT<Eigen::Matrix4d> solver(information);
  if (solver.info() != Eigen::Success || !solver.isPositive()) return std::nullopt;
  const Eigen::Matrix4d inverse = information.inverse();
  const Eigen::Matrix4d found =
      inverse * equations.score_covariance.topLeftCorner<4, 4>() * inverse;
  const Eigen::Vector4d step = inverse * equations.score.head<4>();
  const Eigen::Vector4d independent = inverse.diagonal().cwiseSqrt();
  const Eigen::Vector4d sigma = independent.cwiseMax(found.diagonal().cwiseSqrt());
  if (!step.allFinite() || !(independent.minCoeff() > 0.0)) return std::nullopt;
  return CalibrationStep{step.head<3>(), sigma.head<3>(), independent.head<3>(),
                         step(3),        sigma(3),        independent(3)};
}

CalibrationVector InPriorSigmas(const CalibrationVector& correction,
                                const AdjustmentOptions& options) {
  return correction.cwiseQuotient(PriorSigmas(options));
}

std::optional<ProbableCorrection> BetterCorrection(const CalibrationVector& now,
                                                   const CalibrationEquations& equations,
                                                   const AdjustmentOptions& options) {
  if (options.refine_rig == RigRefinement::kNone) return std::nullopt;
  const bool asks = options.refine_rig == RigRefinement::kAuto && now.isZero();
  if (asks && !Contradicts(equations, options)) return std::nullopt;
  // Directions that hardly show must not follow noise that is shared.
  const double times_as_uncertain =
      Inflation(equations) * options.shared_noise * options.shared_noise;
  CalibrationMatrix system = equations.information / times_as_uncertain;
  CalibrationVector right_side = system * now + equations.score / times_as_uncertain;
  system.diagonal() += PriorSigmas(options).cwiseAbs2().cwiseInverse();
  Hold(FirstHeld(options.refine_rig), system, right_side);
  ProbableCorrection better{system.ldlt().solve(right_side), system.inverse()};
  for (int i = FirstHeld(options.refine_rig); i < kCalibrationSize; ++i) {
    better.covariance(i, i) = 0.0;
  }
  if (!better.correction.allFinite() || !better.covariance.allFinite()) return std::nullopt;
  return better;
}

}  // namespace rigmap
