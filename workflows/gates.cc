#include "workflows/gates.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "core/statistics.h"

namespace rigmap {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

// A gate that passes while its value is at most the limit.
Gate AtMost(std::string name, std::optional<double> value, double limit, std::string why) {
  return {std::move(name), value, limit, !value || *value <= limit, std::move(why)};
}

// Two gates on one thing, of which passing either will do.
void AddEither(Gate a, Gate b, Gates& gates) {
  a.passed = b.passed = a.passed || b.passed;
  gates.push_back(std::move(a));
  gates.push_back(std::move(b));
}

void JudgePrediction(const GateInputs& inputs, const GateOptions& options, Gates& gates) {
  std::size_t predicted = 0;
  for (std::size_t i = 0; i < inputs.odometry.size(); ++i) {
    const bool is_guess = inputs.odometry[i].source == PoseSource::kPredicted;
    if (is_guess && !inputs.adjustment.world_from_left[i]) ++predicted;
  }
  std::optional<double> share;
  if (!inputs.odometry.empty()) {
    share = static_cast<double>(predicted) / static_cast<double>(inputs.odometry.size());
  }
  gates.push_back(AtMost("predicted", share, options.predicted,
                         "share of frames whose pose was guessed, nothing in them being measured"));
}

// What the trajectory's own sigmas say of its frames that were measured.
void JudgeSigmas(const GateInputs& inputs, const GateOptions& options, Gates& gates) {
  std::optional<double> pct;
  double path_m = 0.0, square_m2 = 0.0;
  std::size_t measured = 0;
  const Trajectory& trajectory = inputs.trajectory;
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    const Eigen::Vector3d& here = trajectory[i].world_from_left.translation;
    if (i > 0) path_m += (here - trajectory[i - 1].world_from_left.translation).norm();
    if (trajectory[i].source == PoseSource::kPredicted) continue;
    square_m2 += trajectory[i].sigmas.head<3>().squaredNorm();
    ++measured;
  }
  // A rig that stands has no way to compare with.
  if (measured > 0 && path_m >= inputs.rig.Baseline()) {
    pct = 100.0 * std::sqrt(square_m2 / static_cast<double>(measured)) / path_m;
  }
  gates.push_back(AtMost("position_sigma_pct", pct, options.position_sigma_pct,
                         "root mean square sigma of the measured positions, per cent of the path"));
}

struct StepDifference {
  double sigmas = 0.0, pct = 0.0;
};

// Adjusted against odometric motion of every frame that was measured against a moving reference.
std::vector<StepDifference> StepDifferences(const GateInputs& inputs) {
  std::vector<StepDifference> differences;
  for (std::size_t i = 0; i < inputs.odometry.size(); ++i) {
    const OdometryFrame& frame = inputs.odometry[i];
    const auto reference = static_cast<std::size_t>(frame.reference);
    const auto &to = inputs.adjustment.world_from_left[i],
               &from = inputs.adjustment.world_from_left[reference];
    if (frame.source != PoseSource::kOdometry || reference == i || !to || !from) continue;
    const Rigid3 odometric =
        frame.world_from_left.Inverse() * inputs.odometry[reference].world_from_left;
    const Rigid3 off = (to->Inverse() * *from) * odometric.Inverse();
    Vector6d difference;
    difference << off.translation, LogRotation(off.rotation);
    const double squared = difference.dot(frame.step_covariance.ldlt().solve(difference)) / 6.0;
    const double step_m = odometric.translation.norm();
    differences.push_back({std::sqrt(std::max(0.0, squared)),
                           step_m > 0.0 ? 100.0 * off.translation.norm() / step_m : 0.0});
  }
  return differences;
}

// A step is as far off as the smaller of its two shares of the limits; the gates show the step
// that nine out of ten are better than.
void JudgeMotion(const GateInputs& inputs, const GateOptions& options, Gates& gates) {
  constexpr double kShare = 0.9;
  std::optional<double> sigmas, pct;
  auto differences = StepDifferences(inputs);
  if (!differences.empty()) {
    const auto excess = [&](const StepDifference& step) {
      return std::min(step.sigmas / options.motion_agreement_sigmas,
                      step.pct / options.motion_agreement_pct);
    };
    const StepDifference typical = Quantile(std::move(differences), kShare, excess);
    sigmas = typical.sigmas;
    pct = typical.pct;
  }
  AddEither(AtMost("motion_agreement_sigmas", sigmas, options.motion_agreement_sigmas,
                   "mapped against odometric steps, 90th percentile, in sigmas"),
            AtMost("motion_agreement_pct", pct, options.motion_agreement_pct,
                   "mapped against odometric steps, 90th percentile, per cent of the step"),
            gates);
}

double MedianDepth(const GateInputs& inputs) {
  std::vector<double> depths;
  for (const AdjustedPoint& point : inputs.adjustment.points) {
    const auto& pose = inputs.adjustment.world_from_left[point.observations.front().frame];
    depths.push_back((pose->Inverse() * point.x).z());
  }
  return depths.empty() ? 0.0 : Quantile(std::move(depths), 0.5);
}

// Median distance of the adjusted stereo pairs from their epipolar lines in the right image, by the
// rig as it was corrected: what was found before was measured with the calibrated one.
std::optional<double> EpipolarErrorPx(const Adjustment& adjustment) {
  const StereoRig& rig = adjustment.rig;
  const Eigen::Matrix3d essential =
      Skew(rig.right_from_left.translation) * rig.right_from_left.rotation.toRotationMatrix();
  std::vector<double> errors_px;
  for (const AdjustedPoint& point : adjustment.points) {
    for (std::size_t i = 0; i + 1 < point.observations.size(); ++i) {
      const PointObservation &left = point.observations[i], &right = point.observations[i + 1];
      if (left.frame != right.frame) continue;
      const auto x = Undistort(rig.left.camera, left.pixel);
      const auto y = Undistort(rig.right.camera, right.pixel);
      if (!x || !y) continue;
      const Eigen::Vector3d line = essential * x->homogeneous();
      errors_px.push_back(rig.right.camera.MeanFocal() * std::abs(y->homogeneous().dot(line)) /
                          line.head<2>().norm());
    }
  }
  if (errors_px.empty()) return std::nullopt;
  return Median(std::move(errors_px));
}

// A rig that the part corrected has to stay near its calibration.
void JudgeCorrection(const GateInputs& inputs, const GateOptions& options, Gates& gates) {
  std::optional<double> sigmas;
  if (inputs.adjustment.IsRigCorrected()) {
    sigmas = inputs.adjustment.rig_correction_sigmas.cwiseAbs().maxCoeff();
  }
  gates.push_back(AtMost("rig_refinement_sigmas", sigmas, options.rig_refinement_sigmas,
                         "how far the rig was corrected, in sigmas of what a calibration errs by"));
}

// The sigma that may excuse a correction. One that has grown beyond the limit has not grown by the
// noise of tracks, but by what a wrong rig leaves over.
double Excusing(double sigma, double sigma_if_independent, double limit) {
  return sigma <= limit ? sigma : sigma_if_independent;
}

void JudgeCalibration(const GateInputs& inputs, const GateOptions& options, Gates& gates) {
  std::optional<double> turn_deg, turn_sigmas, focal_pct, focal_sigmas;
  std::string turn_why = "the path cannot determine it", focal_why = turn_why;
  const double depth_m = MedianDepth(inputs);
  const double max_turn_rad =
      depth_m > 0.0 ? options.max_depth_error_share * inputs.rig.Baseline() / depth_m : 1.0;
  const auto step = inputs.adjustment.calibration
                        ? RotationAndFocalStep(*inputs.adjustment.calibration)
                        : std::nullopt;
  if (step) {
    // A correction that the path cannot tell to the limit says nothing.
    if (step->rig_rotation_sigma_if_independent.maxCoeff() < max_turn_rad) {
      turn_deg = kDegrees * step->rig_rotation.norm();
      turn_sigmas = 0.0;
      for (int axis = 0; axis < 3; ++axis) {
        const double sigma = Excusing(step->rig_rotation_sigma(axis),
                                      step->rig_rotation_sigma_if_independent(axis), max_turn_rad);
        turn_sigmas = std::max(*turn_sigmas, std::abs(step->rig_rotation(axis)) / sigma);
      }
      turn_why = fmt::format(
          "the images would turn the right camera by {:.4f} {:.4f} {:.4f} degrees about its x y z",
          kDegrees * step->rig_rotation.x(), kDegrees * step->rig_rotation.y(),
          kDegrees * step->rig_rotation.z());
    }
    const double max_log_focal = options.intrinsics_consistency_pct / 100.0;
    if (step->log_focal_sigma_if_independent < max_log_focal) {
      focal_pct = 100.0 * std::abs(step->log_focal);
      focal_sigmas =
          std::abs(step->log_focal) /
          Excusing(step->log_focal_sigma, step->log_focal_sigma_if_independent, max_log_focal);
      focal_why = fmt::format("the images would change the focal lengths by {:+.3f} %",
                              100.0 * step->log_focal);
    }
  }
  AddEither(AtMost("rig_consistency_deg", turn_deg, kDegrees * max_turn_rad, turn_why),
            AtMost("rig_consistency_sigmas", turn_sigmas, options.consistency_sigmas, turn_why),
            gates);
  AddEither(
      AtMost("intrinsics_consistency_pct", focal_pct, options.intrinsics_consistency_pct,
             focal_why),
      AtMost("intrinsics_consistency_sigmas", focal_sigmas, options.consistency_sigmas, focal_why),
      gates);
}

}  // namespace

OptionFields GateOptions::Fields() {
  return {{"baseline_spread", &baseline_spread},
          {"baseline_rejected", &baseline_rejected},
          {"registered", &registered},
          {"predicted", &predicted},
          {"position_sigma_pct", &position_sigma_pct},
          {"motion_agreement_sigmas", &motion_agreement_sigmas},
          {"motion_agreement_pct", &motion_agreement_pct},
          {"reprojection_px", &reprojection_px},
          {"outlier_share", &outlier_share},
          {"epipolar_px", &epipolar_px},
          {"rig_refinement_sigmas", &rig_refinement_sigmas},
          {"max_depth_error_share", &max_depth_error_share},
          {"intrinsics_consistency_pct", &intrinsics_consistency_pct},
          {"consistency_sigmas", &consistency_sigmas},
          {"depth_bias_px", &depth_bias_px}};
}

void GateOptions::Validate() const {
  GateOptions copy = *this;
  for (const OptionField& field : copy.Fields()) {
    const double value = *std::get<double*>(field.value);
    RequireOption(value > 0.0, "gates." + field.name, "more than 0", value);
  }
}

Gates JudgeMapping(const PlacedKeyframes* placed, const GateOptions& options) {
  Gates gates;
  std::optional<double> spread, rejected, registered;
  if (placed) {
    std::size_t used = 0, off = 0;
    for (const PlacedModel& model : placed->models) {
      spread = std::max(spread.value_or(0.0), model.scale.relative_spread);
      used += model.scale.pairs_used.size();
      off += model.scale.pairs_rejected.size();
    }
    rejected = static_cast<double>(off) / std::max<double>(1.0, static_cast<double>(used + off));
    const auto& poses = placed->world_from_left;
    const auto posed = std::count_if(poses.begin(), poses.end(),
                                     [](const auto& pose) { return pose.has_value(); });
    registered = static_cast<double>(posed) / static_cast<double>(poses.size());
  }
  gates.push_back(AtMost("baseline_spread", spread, options.baseline_spread,
                         "spread of the mapped left-right distances: the shape of the map"));
  gates.push_back(AtMost("baseline_rejected", rejected, options.baseline_rejected,
                         "share of left-right distances rejected when the scale was taken"));
  gates.push_back({"registered", registered, options.registered,
                   !registered || *registered >= options.registered,
                   "share of keyframes in the model used"});
  return gates;
}

bool AllPassed(const Gates& gates) {
  return std::all_of(gates.begin(), gates.end(), [](const Gate& gate) { return gate.passed; });
}

Gates JudgeAdjustment(const GateInputs& inputs, const GateOptions& options) {
  Gates gates;
  JudgeMotion(inputs, options, gates);
  const bool adjusted = !inputs.adjustment.points.empty();
  const auto if_adjusted = [&](double value) {
    return adjusted ? std::optional(value) : std::nullopt;
  };
  gates.push_back(AtMost("reprojection_px", if_adjusted(inputs.adjustment.reprojection_px),
                         options.reprojection_px, "median reprojection error after adjustment"));
  gates.push_back(AtMost("outlier_share", if_adjusted(inputs.adjustment.outlier_share),
                         options.outlier_share, "observations dropped by the adjustment"));
  return gates;
}

Gates JudgePart(const GateInputs& inputs, const GateOptions& options) {
  Gates gates = JudgeMapping(inputs.placed, options);
  JudgePrediction(inputs, options, gates);
  JudgeSigmas(inputs, options, gates);
  const Gates adjusted = JudgeAdjustment(inputs, options);
  gates.insert(gates.end(), adjusted.begin(), adjusted.end());
  std::optional<double> epipolar;
  if (inputs.adjustment.IsRigCorrected()) {
    epipolar = EpipolarErrorPx(inputs.adjustment);
  } else if (!inputs.epipolar_px.empty()) {
    epipolar = Quantile(inputs.epipolar_px, 0.5);
  }
  gates.push_back(AtMost("epipolar_px", epipolar, options.epipolar_px,
                         "median distance of stereo matches from their epipolar line"));
  JudgeCorrection(inputs, options, gates);
  JudgeCalibration(inputs, options, gates);
  return gates;
}

Gate JudgeDepthBias(std::optional<double> bias_px, const GateOptions& options) {
  const auto size_px = bias_px ? std::optional(std::abs(*bias_px)) : std::nullopt;
  return AtMost("depth_bias_px", size_px, options.depth_bias_px,
                "median disparity of dense matching minus that of sparse points");
}

std::string FailureReason(const Gates& gates) {
  std::vector<std::string> failed;
  const std::string* said = nullptr;
  for (const Gate& gate : gates) {
    // Of two gates on one thing the first speaks for both.
    if (gate.passed || !gate.value || (said && gate.why == *said)) continue;
    said = &gate.why;
    failed.push_back(fmt::format("gate {} is {:.4g}, limit {:.4g}: {}", gate.name, *gate.value,
                                 gate.limit, gate.why));
  }
  return fmt::format("{}", fmt::join(failed, "; "));
}

}  // namespace rigmap
