#include "workflows/stages/gates.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "adjustment/calibration.h"
#include "adjustment/unchecked_scale.h"
#include "gates/length_gate.h"
#include "gates/refusal.h"
#include "gates/registration_gates.h"
#include "pipeline/code_identity.h"
#include "scale/free_camera_poses.h"
#include "workflows/stages/depth_consistency_report.h"
#include "workflows/stages/gates_report.h"

namespace rigmap {
namespace {

// What the metres rest on, for the verdict.
std::string AboutRig(const GateInputs& inputs) {
  constexpr double kTelling_px = 0.1, kTellingFinely_px = 0.005;
  const StereoRig& rig = inputs.rig;
  const Adjustment& adjustment = inputs.adjustment;
  std::string about;
  if (adjustment.IsRigCorrected()) {
    about = fmt::format(
        "the rig file was off by {:.2g} px in the right image ({:+.2f} px of disparity at "
        "infinity) "
        "and has been corrected; ",
        adjustment.correction_px, adjustment.infinity_offset_px);
  }
  if (adjustment.lens_field_rms_px >= kTellingFinely_px) {
    about += fmt::format("a field of {:.2g} px mends what the lens model lacks; ",
                         adjustment.lens_field_rms_px);
  }
  const double flexure_px = FlexurePx(adjustment.rig.right.camera, adjustment.right_turns).norm();
  if (flexure_px >= kTellingFinely_px) {
    about += fmt::format(
        "the rig gives: its right image moves by {:.2g} px about its mean, which is followed; ",
        flexure_px);
  }
  if (inputs.calibration_scale_sigma > 0.0) about += "the calibration is not corrected; ";
  if (std::abs(inputs.asked_offset_px) >= kTelling_px) {
    about += fmt::format("the images contradict the rig file, every disparity by {:.2g} px; ",
                         std::abs(inputs.asked_offset_px));
  }
  if (rig.baseline_sigma_m) return about + "the baseline's sigma counted";
  return about + fmt::format("if the baseline is {:.2f} mm", 1000.0 * rig.Baseline());
}

// How far off depths are with a rig file that errs as rig files do: by an offset of all
// disparities.
std::string OfRigFiles(const GateInputs& inputs) {
  constexpr double kSigmas95 = 1.960;
  const double offset_px = kSigmas95 * inputs.adjustment.infinity_offset_sigma_px;
  if (!(offset_px > 0.0)) return "";
  const double pixel_metres = inputs.rig.left.camera.fx * inputs.rig.Baseline();
  return fmt::format(": as these err, off by up to {:.2g} % for each metre of depth (95 %)",
                     100.0 * offset_px / pixel_metres);
}

// Beside the gates: how good the poses are, for the verdict.
Report ReportPart(const GateInputs& inputs, const GateOptions& options) {
  const PartFindings findings = FindingsOf(inputs, options);
  const Accuracy& accuracy = findings.accuracy;
  Report report = ReportGates(JudgePart(inputs, options));
  report["verdict"] = ReportFindings(findings);
  std::string text;
  if (accuracy.scale_95_pct && !std::isfinite(*accuracy.scale_95_pct)) {
    text = "of metres nothing is known; ";
  } else if (accuracy.scale_95_pct) {
    text = fmt::format("metres good to {}; ", HowGood(findings));
    if (!findings.guessed.empty()) {
      text += fmt::format(
          "{} of {} poses are guessed, {}; ", findings.GuessedCount(), findings.frames,
          std::isfinite(findings.guessed_95_m) ? "the worst to " + LengthText(findings.guessed_95_m)
                                               : "of which that says nothing");
    }
    if (!findings.bridged.empty()) {
      text += fmt::format("{} of {} steps are by wheels and gyro, since no image shows them; ",
                          findings.bridged.size(), findings.frames - 1);
    }
  } else {
    if (accuracy.position_95_m) {
      text = fmt::format(
          "the way is shorter than the baseline, so that no length is judged; positions good to {} "
          "(95 %); ",
          LengthText(*accuracy.position_95_m));
    }
    text += "nothing checks the metres of depths and map, which are the rig file's" +
            OfRigFiles(inputs) + "; ";
  }
  report["verdict"]["text"] = text + AboutRig(inputs);
  report["depth_consistency"] = ReportDepthConsistency(inputs.depth_consistency);
  return report;
}

GateInputs InputsOf(const Dataset& dataset, const FeatureIndex& features,
                    const AlignedKeyframes& aligned, const AdjustedPart& part) {
  return {dataset.rig,
          part.odometry,
          part.adjustment,
          part.trajectory,
          aligned.world_from_left.empty() ? nullptr : &aligned,
          part.rests_on_mapping,
          features.epipolar_px,
          DepthConsistencyOf(part.adjustment),
          part.KnowsPositions()};
}

Report JudgeAdjusted(const Dataset& dataset, const FeatureIndex& features,
                     const AlignedKeyframes& aligned, const AdjustedPart& part,
                     const MappingGateOptions& mapping, const PoseGateOptions& poses,
                     const AdjustmentGateOptions& adjustment,
                     const CalibrationGateOptions& calibration) {
  return ReportPart(InputsOf(dataset, features, aligned, part),
                    {mapping, poses, adjustment, calibration, {}, {}});
}

// Of poses that nothing holds to the rig from frame to frame.
Gate LengthOf(const GateInputs& inputs, const Odometry& odometry, const PoseGateOptions& options) {
  return JudgeLength(inputs.adjustment.world_from_left, odometry, inputs.rig.Baseline(),
                     options.accuracy_pct);
}

Report JudgeMapped(const Dataset& dataset, const FeatureIndex& features,
                   const AlignedKeyframes& aligned, const AdjustedPart& part,
                   const MappingGateOptions& mapping, const PoseGateOptions& poses,
                   const AdjustmentGateOptions& adjustment,
                   const CalibrationGateOptions& calibration, const AdjustmentOptions& prior) {
  GateInputs inputs = InputsOf(dataset, features, aligned, part);
  inputs.calibration_scale_sigma = UncheckedFocalSigma(dataset.rig, prior);
  Report report = ReportPart(inputs, {mapping, poses, adjustment, calibration, {}, {}});
  return WithMoreGates({}, report, ReportGates({LengthOf(inputs, part.odometry, poses)}));
}

Report JudgeFreeCameras(const Dataset& dataset, const MappingResult& mapped,
                        const AlignedKeyframes& aligned, const AdjustedPart& part,
                        const MappingGateOptions& mapping, const PoseGateOptions& poses,
                        const AdjustmentGateOptions& adjustment,
                        const CalibrationGateOptions& calibration, const AdjustmentOptions& prior) {
  // Lengths differ by the change to first order; from here on its square is half as much, and no
  // sigma speaks of lengths any more.
  constexpr double kFirstOrder = 0.5;
  GateInputs inputs{dataset.rig, part.odometry, part.adjustment, part.trajectory, &aligned};
  inputs.positions_known = part.KnowsPositions();
  double focal = 0.0, depth = 0.0;
  for (const AlignedModel& laid : aligned.models) {
    const SparseModel& model = mapped.models[static_cast<std::size_t>(laid.model)];
    focal = std::max(focal, FocalLengthChange(model, dataset.rig));
    depth = std::max(depth, DepthChange(model, laid.scale.metres_per_model_unit, dataset.rig)
                                .value_or(std::numeric_limits<double>::infinity()));
  }
  const double change = std::max(focal, depth);
  inputs.calibration_scale_sigma = change < kFirstOrder
                                       ? std::hypot(change, UncheckedFocalSigma(dataset.rig, prior))
                                       : std::numeric_limits<double>::infinity();
  Report report = ReportPart(inputs, {mapping, poses, adjustment, calibration, {}, {}});
  std::string text = report["verdict"]["text"];
  text +=
      fmt::format("; COLMAP's focal lengths are up to {:.2g} % off the rig file's", 100.0 * focal);
  if (std::isfinite(depth)) text += fmt::format(", its depths {:.2g} %", 100.0 * depth);
  report["verdict"]["text"] = text;
  return report;
}

Report JudgeOdometric(const Dataset& dataset, const FeatureIndex& features,
                      const Odometry& odometry, const OdometricPart& part,
                      const MappingGateOptions& mapping, const PoseGateOptions& poses,
                      const AdjustmentGateOptions& adjustment,
                      const CalibrationGateOptions& calibration) {
  Adjustment none;
  none.world_from_left.resize(odometry.size());
  GateInputs inputs{dataset.rig, odometry, none, part.trajectory};
  inputs.epipolar_px = features.epipolar_px;
  inputs.calibration_scale_sigma = part.calibration_scale_sigma;
  inputs.asked_offset_px = part.asked_offset_px;
  return ReportPart(inputs, {mapping, poses, adjustment, calibration, {}, {}});
}

Report JudgeRegistered(const Dataset& dataset, const FeatureIndex& features,
                       const Odometry& odometry, const Registration& registration,
                       const OdometricPart& part, const MappingGateOptions& mapping,
                       const PoseGateOptions& poses, const AdjustmentGateOptions& adjustment,
                       const CalibrationGateOptions& calibration,
                       const RegistrationGateOptions& of_registration) {
  const Adjustment registered = AsAdjustment(registration);
  const Odometry compared = WithNoiseOf(registration, odometry);
  GateInputs inputs{dataset.rig, compared, registered, part.trajectory};
  inputs.epipolar_px = features.epipolar_px;
  inputs.calibration_scale_sigma = part.calibration_scale_sigma;
  inputs.asked_offset_px = part.asked_offset_px;
  Report report = ReportPart(inputs, {mapping, poses, adjustment, calibration, {}, {}});
  Gates gates = JudgeRegistration(registration, of_registration);
  gates.push_back(LengthOf(inputs, odometry, poses));
  return WithMoreGates({}, report, ReportGates(gates));
}

Report JudgeDeadReckoned(const Dataset& dataset, const FeatureIndex& features,
                         const Odometry& steps, const OdometricPart& part,
                         const MappingGateOptions& mapping, const PoseGateOptions& poses,
                         const AdjustmentGateOptions& adjustment,
                         const CalibrationGateOptions& calibration) {
  // Poses owe nothing to the cameras, so the baseline's sigma is not theirs.
  Dataset without = {.rig = dataset.rig};
  without.rig.baseline_sigma_m.reset();
  Report report =
      JudgeOdometric(without, features, steps, part, mapping, poses, adjustment, calibration);
  Report& verdict = report["verdict"];
  verdict["known"]["baseline_m"] = 0.0;
  std::string text = verdict["text"];
  text.resize(text.rfind(';') == std::string::npos ? 0 : text.rfind(';') + 2);
  verdict["text"] = text + "by the wheels, the sigma of their radius and slip counted";
  return report;
}

Report JudgeDepths(const DepthIndex& depths, const DepthGateOptions& options) {
  return ReportGates({JudgeDepthBias(depths.bias_px, options)});
}

}  // namespace

AdjustedGatesCheck AdjustedGates() {
  return {.name = "gates",
          .code = CodeHere(),
          .make = JudgeAdjusted,
          .about = "whether the result contradicts itself"};
}

MappedGatesCheck MappedGates() {
  return {.name = "gates",
          .code = CodeHere(),
          .make = JudgeMapped,
          .about = "whether the result contradicts itself"};
}

FreeCameraGatesCheck FreeCameraGates() {
  return {.name = "gates",
          .code = CodeHere(),
          .make = JudgeFreeCameras,
          .about = "the gates that apply to cameras posed apart from each other"};
}

OdometricGatesCheck OdometricGates() {
  return {.name = "gates",
          .code = CodeHere(),
          .make = JudgeOdometric,
          .about = "the gates that apply to poses that nothing adjusted"};
}

OdometricGatesCheck DeadReckonedGates() {
  return {.name = "gates",
          .code = CodeHere(),
          .make = JudgeDeadReckoned,
          .about = "the gates that apply to poses that wheels and gyro tell"};
}

RegistrationGatesCheck RegistrationGates() {
  return {.name = "gates",
          .code = CodeHere(),
          .make = JudgeRegistered,
          .about = "whether registrations contradict each other, themselves or the odometry"};
}

DepthGatesCheck DepthGates() {
  return {.name = "depth_gates",
          .code = CodeHere(),
          .make = JudgeDepths,
          .about = "whether dense depth agrees with the sparse points"};
}

Report WithMoreGates(const StageContext&, const Report& gates, const Report& more) {
  Report all = gates;
  for (const Report& gate : more.at("gates")) all["gates"].push_back(gate);
  return all;
}

Warning WarningByGates(const StageContext&, const Report& gates, const Report& depth_gates) {
  JudgedPart judged = ReadJudged(gates);
  for (const Gate& gate : ReadGates(depth_gates)) judged.gates.push_back(gate);
  return {WarningOf(RefusalOf(judged.gates, judged.findings))};
}

}  // namespace rigmap
