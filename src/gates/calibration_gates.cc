// The gates that ask whether the images and the rig's calibration contradict each other.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "adjustment/calibration.h"
#include "core/statistics.h"
#include "features/stereo_matches.h"
#include "gates/gates.h"

namespace rigmap {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

double MedianDepth(const GateInputs& inputs) {
  std::vector<double> depths;
  for (const AdjustedPoint& point : inputs.adjustment.points) {
    const auto& pose = inputs.adjustment.world_from_left[point.observations.front().frame];
    depths.push_back((pose->Inverse() * point.x).z());
  }
  return depths.empty() ? 0.0 : Quantile(std::move(depths), 0.5);
}

// By the rig as it was corrected: what was found before was measured with the calibrated one.
std::optional<double> CorrectedEpipolarPx(const Adjustment& adjustment) {
  std::vector<double> errors_px;
  for (const AdjustedPoint& point : adjustment.points) {
    for (std::size_t i = 0; i + 1 < point.observations.size(); ++i) {
      const PointObservation &left = point.observations[i], &right = point.observations[i + 1];
      if (left.frame != right.frame) continue;
      const auto error = EpipolarErrorPx(adjustment.rig, left.pixel, right.pixel);
      if (error) errors_px.push_back(*error);
    }
  }
  if (errors_px.empty()) return std::nullopt;
  return MedianAbsolute(std::move(errors_px));
}

void JudgeEpipolar(const GateInputs& inputs, const CalibrationGateOptions& options, Gates& gates) {
  std::optional<double> epipolar_px;
  if (inputs.adjustment.IsRigCorrected()) {
    epipolar_px = CorrectedEpipolarPx(inputs.adjustment);
  } else if (!inputs.epipolar_px.empty()) {
    epipolar_px = Median(inputs.epipolar_px);
  }
  gates.push_back(AtMost("epipolar_px", epipolar_px, options.epipolar_px,
                         "median distance of stereo matches from their epipolar line"));
}

// A rig that the part corrected has to stay near its calibration: within a share of the image, or
// where corrections lie that its prior expects, of which one like this may have three sigmas.
void JudgeCorrection(const GateInputs& inputs, const CalibrationGateOptions& options,
                     Gates& gates) {
  constexpr double kMostSigmas = 3.0;
  std::optional<double> shift_px;
  double limit_px = options.rig_refinement_share * inputs.rig.left.camera.width;
  if (inputs.adjustment.IsRigCorrected()) {
    shift_px = inputs.adjustment.correction_px;
    const double sigmas = inputs.adjustment.correction_prior_sigmas;
    if (sigmas > 0.0) limit_px = std::max(limit_px, kMostSigmas / sigmas * *shift_px);
  }
  gates.push_back(AtMost("rig_refinement_px", shift_px, limit_px,
                         "the rig file is off by more than a calibration errs: of another rig?"));
}

// The sigma that a correction is compared with. An inflated sigma beyond the limit does not come
// from the noise of tracks, but from errors of a wrong rig: then the one without inflation is
// taken.
double Excusing(double sigma, double sigma_if_independent, double limit) {
  return sigma <= limit ? sigma : sigma_if_independent;
}

// A correction that the images ask for, and by how many of its sigmas it is beyond its limit.
struct Asked {
  double value = 0.0;
  double beyond_sigmas = 0.0;
};

Asked AskedFor(double value, double sigma, double limit) {
  return {std::abs(value), std::max(0.0, std::abs(value) - limit) / sigma};
}

// Of the angle of a turn by axes of these sigmas.
double AngleSigma(const CalibrationStep& step, const Eigen::Vector3d& sigma) {
  const Eigen::Vector3d& by = step.rig_rotation;
  const Eigen::Vector3d axis = by.isZero() ? Eigen::Vector3d::UnitY() : by.normalized();
  const Eigen::Vector3d along = axis.cwiseProduct(sigma);
  return std::sqrt(along.dot(step.rig_rotation_correlation * along));
}

// A gate that a value beyond its limit passes as long as that may be chance.
Gate SurelyAtMost(std::string name, const std::optional<Asked>& asked, double limit,
                  double consistency_sigmas, std::string why) {
  Gate gate = AtMost(std::move(name), std::nullopt, limit, std::move(why));
  if (!asked) return gate;
  gate.value = asked->value;
  gate.passed = asked->beyond_sigmas <= consistency_sigmas;
  return gate;
}

Gate BeyondSigmas(std::string name, const std::optional<Asked>& asked, double consistency_sigmas,
                  std::string why) {
  const auto sigmas = asked ? std::optional(asked->beyond_sigmas) : std::nullopt;
  return AtMost(std::move(name), sigmas, consistency_sigmas, std::move(why));
}

void JudgeConsistency(const GateInputs& inputs, const CalibrationGateOptions& options,
                      Gates& gates) {
  std::optional<Asked> turn, offset, focal;  // degrees, px, per cent
  std::string turn_why = "the path cannot determine it", offset_why = turn_why,
              focal_why = turn_why;
  const double depth_m = MedianDepth(inputs);
  const double max_turn_rad =
      depth_m > 0.0 ? options.max_depth_error_share * inputs.rig.Baseline() / depth_m : 1.0;
  const double focal_px = inputs.rig.right.camera.MeanFocal();
  const auto step = inputs.adjustment.calibration
                        ? RotationAndFocalStep(*inputs.adjustment.calibration)
                        : std::nullopt;
  if (step) {
    // A correction that the path cannot tell to the limit says nothing.
    if (step->rig_rotation_sigma_if_independent.maxCoeff() < max_turn_rad) {
      Eigen::Vector3d sigma;
      for (int axis = 0; axis < 3; ++axis) {
        sigma(axis) = Excusing(step->rig_rotation_sigma(axis),
                               step->rig_rotation_sigma_if_independent(axis), max_turn_rad);
      }
      const Eigen::Vector3d& by = step->rig_rotation;
      turn = AskedFor(by.norm(), AngleSigma(*step, sigma), max_turn_rad);
      turn->value *= kDegrees;
      offset = AskedFor(by.y(), sigma.y(), max_turn_rad);
      offset->value *= focal_px;
      turn_why = fmt::format(
          "the images would turn the right camera by {:.4f} {:.4f} {:.4f} degrees about its x y z",
          kDegrees * step->rig_rotation.x(), kDegrees * step->rig_rotation.y(),
          kDegrees * step->rig_rotation.z());
      offset_why = fmt::format(
          "the images would change the disparity at infinity by {:+.3f} px (sigma {:.3f} px)",
          -focal_px * by.y(), focal_px * sigma.y());
    }
    const double max_log_focal = options.intrinsics_consistency_pct / 100.0;
    if (step->log_focal_sigma_if_independent < max_log_focal) {
      focal = AskedFor(
          step->log_focal,
          Excusing(step->log_focal_sigma, step->log_focal_sigma_if_independent, max_log_focal),
          max_log_focal);
      focal->value *= 100.0;
      focal_why = fmt::format("the images would change the focal lengths by {:+.3f} %",
                              100.0 * step->log_focal);
    }
  }
  // Where all of the rig was asked for, what is not known of it is in the sigmas, and a step with
  // most of it held says little.
  const bool is_diagnostic = inputs.adjustment.refined == RigRefinement::kAllButFocal ||
                             inputs.adjustment.refined == RigRefinement::kAll;
  const double sigmas = options.consistency_sigmas;
  for (Gate& gate : Gates{
           SurelyAtMost("infinity_offset_px", offset, focal_px * max_turn_rad, sigmas, offset_why),
           SurelyAtMost("rig_consistency_deg", turn, kDegrees * max_turn_rad, sigmas, turn_why),
           BeyondSigmas("rig_consistency_sigmas", turn, sigmas, turn_why),
           SurelyAtMost("intrinsics_consistency_pct", focal, options.intrinsics_consistency_pct,
                        sigmas, focal_why),
           BeyondSigmas("intrinsics_consistency_sigmas", focal, sigmas, focal_why)}) {
    gate.passed = gate.passed || is_diagnostic;
    gates.push_back(std::move(gate));
  }
}

}  // namespace

Gates JudgeCalibration(const GateInputs& inputs, const CalibrationGateOptions& options) {
  Gates gates;
  JudgeEpipolar(inputs, options, gates);
  JudgeCorrection(inputs, options, gates);
  JudgeConsistency(inputs, options, gates);
  return gates;
}

}  // namespace rigmap
