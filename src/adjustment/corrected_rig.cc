// What a correction makes of the rig, and of what is infinitely far.
#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "adjustment/calibration.h"

namespace rigmap {

StereoRig Corrected(const StereoRig& rig, const CalibrationVector& correction) {
  StereoRig corrected = rig;
  corrected.right_from_left =
      Rigid3{ExpRotation(correction.segment<3>(kRotationX)), Eigen::Vector3d::Zero()} *
      rig.right_from_left;
  const auto correct = [&](Camera& camera, double log_focal, double log_aspect, int centre,
                           int k1) {
    camera.fx *= std::exp(log_focal);
    camera.fy *= std::exp(log_focal + log_aspect);
    camera.cx += correction(centre);
    camera.cy += correction(centre + 1);
    camera.k1 += correction(k1);
    camera.k2 += correction(k1 + 1);
    camera.p1 += correction(k1 + 2);
    camera.p2 += correction(k1 + 3);
  };
  correct(corrected.left.camera, correction(kLogFocal), correction(kLogAspect), kLeftCx, kLeftK1);
  correct(corrected.right.camera, correction(kLogFocal) + correction(kLogRightFocal),
          correction(kLogAspect) + correction(kLogRightAspect), kRightCx, kRightK1);
  return corrected;
}

CalibrationVector CorrectionBetween(const StereoRig& from, const StereoRig& to) {
  CalibrationVector correction;
  correction.segment<3>(kRotationX) =
      LogRotation(to.right_from_left.rotation * from.right_from_left.rotation.conjugate());
  const auto between = [&](const Camera& a, const Camera& b, int centre, int k1) {
    correction.segment<2>(centre) << b.cx - a.cx, b.cy - a.cy;
    correction.segment<4>(k1) << b.k1 - a.k1, b.k2 - a.k2, b.p1 - a.p1, b.p2 - a.p2;
    const double by_x = std::log(b.fx / a.fx), by_y = std::log(b.fy / a.fy);
    return std::pair(by_x, by_y - by_x);
  };
  std::tie(correction(kLogFocal), correction(kLogAspect)) =
      between(from.left.camera, to.left.camera, kLeftCx, kLeftK1);
  const auto [right_focal, right_aspect] =
      between(from.right.camera, to.right.camera, kRightCx, kRightK1);
  correction(kLogRightFocal) = right_focal - correction(kLogFocal);
  correction(kLogRightAspect) = right_aspect - correction(kLogAspect);
  return correction;
}

double SigmaOf(double (*function)(const StereoRig&), const StereoRig& rig,
               const CalibrationVector& correction, const CalibrationVector& prior_sigmas,
               const CalibrationMatrix& covariance) {
  constexpr double kStepSigmas = 0.01;  // of the prior: where the function is linear
  CalibrationVector gradient;
  for (int i = 0; i < kCalibrationSize; ++i) {
    CalibrationVector ahead = correction, behind = correction;
    ahead(i) += kStepSigmas * prior_sigmas(i);
    behind(i) -= kStepSigmas * prior_sigmas(i);
    gradient(i) = (function(Corrected(rig, ahead)) - function(Corrected(rig, behind))) /
                  (2.0 * kStepSigmas * prior_sigmas(i));
  }
  return std::sqrt(std::max(0.0, gradient.dot(covariance * gradient)));
}

std::optional<Eigen::Vector2d> RightPixelAtInfinity(const StereoRig& rig,
                                                    const Eigen::Vector2d& left) {
  const auto ray = Undistort(rig.left.camera, left);
  if (!ray) return std::nullopt;
  return Project(rig.right.camera, rig.right_from_left.rotation * ray->homogeneous());
}

double DisparityAtInfinity(const StereoRig& rig) {
  const Camera& camera = rig.left.camera;
  const Eigen::Vector2d middle(0.5 * (camera.width - 1), 0.5 * (camera.height - 1));
  const auto right = RightPixelAtInfinity(rig, middle);
  return right ? middle.x() - right->x() : 0.0;
}

namespace {

// Pixels all over the left image, nine along each side.
std::vector<Eigen::Vector2d> PixelsOver(const Camera& camera) {
  constexpr int kSteps = 8;
  std::vector<Eigen::Vector2d> pixels;
  for (int column = 0; column <= kSteps; ++column) {
    for (int row = 0; row <= kSteps; ++row) {
      pixels.emplace_back(static_cast<double>(column * (camera.width - 1)) / kSteps,
                          static_cast<double>(row * (camera.height - 1)) / kSteps);
    }
  }
  return pixels;
}

std::optional<Eigen::Vector2d> ShiftAtInfinity(const StereoRig& from, const StereoRig& to,
                                               const Eigen::Vector2d& left) {
  const auto a = RightPixelAtInfinity(from, left), b = RightPixelAtInfinity(to, left);
  if (!a || !b) return std::nullopt;
  return *b - *a;
}

}  // namespace

double LargestShiftPx(const StereoRig& from, const StereoRig& to) {
  double largest_px = 0.0;
  for (const Eigen::Vector2d& left : PixelsOver(from.left.camera)) {
    if (const auto shift = ShiftAtInfinity(from, to, left)) {
      largest_px = std::max(largest_px, shift->norm());
    }
  }
  return largest_px;
}

Eigen::Vector2d Steadied(const Camera& right, const Eigen::Vector3d& turn,
                         const Eigen::Vector2d& pixel) {
  const auto ray = Undistort(right, pixel);
  if (!ray) return pixel;
  return Distort(right, (ExpRotation(-turn) * ray->homogeneous()).hnormalized());
}

Eigen::Vector3d FlexurePx(const Camera& right, const std::vector<Eigen::Vector3d>& turns) {
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  int known = 0;
  for (const Eigen::Vector3d& turn : turns) {
    if (turn.isZero()) continue;  // of a frame that was not adjusted
    squares += turn.cwiseAbs2();
    ++known;
  }
  if (known == 0) return Eigen::Vector3d::Zero();
  const double focal = right.MeanFocal(), distance = right.RmsDistancePx();
  const Eigen::Vector3d rms = (squares / known).cwiseSqrt();
  return rms.cwiseProduct(Eigen::Vector3d(focal, focal, distance));
}

double LargestShiftSigmas(const StereoRig& from, const StereoRig& to,
                          const CalibrationPrior& prior) {
  constexpr double kStepSigmas = 0.01;  // where shifts are linear
  const CalibrationMatrix covariance = prior.information.inverse();
  std::vector<StereoRig> stepped;
  for (int i = 0; i < kCalibrationSize; ++i) {
    stepped.push_back(Corrected(from, kStepSigmas * prior.sigmas(i) * CalibrationVector::Unit(i)));
  }
  double largest = 0.0;
  for (const Eigen::Vector2d& left : PixelsOver(from.left.camera)) {
    const auto shift = ShiftAtInfinity(from, to, left);
    Eigen::Matrix<double, 2, kCalibrationSize> by_calibration;
    bool is_seen = shift.has_value();
    for (int i = 0; i < kCalibrationSize && is_seen; ++i) {
      const auto step = ShiftAtInfinity(from, stepped[static_cast<std::size_t>(i)], left);
      is_seen = step.has_value();
      if (step) by_calibration.col(i) = *step / (kStepSigmas * prior.sigmas(i));
    }
    if (!is_seen) continue;
    const double expected_px =
        std::sqrt((by_calibration * covariance * by_calibration.transpose()).trace());
    largest = std::max(largest, shift->norm() / std::max(expected_px, 1e-12));
  }
  return largest;
}

}  // namespace rigmap
