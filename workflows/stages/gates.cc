#include "workflows/stages/gates.h"

#include <fmt/format.h>

#include "gates/accuracy.h"
#include "pipeline/code_identity.h"
#include "workflows/stages/depth_consistency_report.h"
#include "workflows/stages/mapping.h"

namespace rigmap {
namespace {

Report ReportGates(const Gates& gates) {
  Report list = Report::array();
  for (const Gate& gate : gates) {
    list.push_back({{"name", gate.name},
                    {"value", gate.value ? Report(*gate.value) : Report(nullptr)},
                    {"limit", gate.limit},
                    {"passed", gate.passed},
                    {"why", gate.why}});
  }
  return {{"gates", std::move(list)}};
}

std::string Length(double metres) {
  return metres < 0.01  ? fmt::format("{:.1f} mm", 1000.0 * metres)
         : metres < 1.0 ? fmt::format("{:.1f} cm", 100.0 * metres)
                        : fmt::format("{:.2f} m", metres);
}

// What the metres rest on, for the verdict.
std::string AboutRig(const StereoRig& rig, const Adjustment& adjustment) {
  std::string about;
  if (adjustment.IsRigCorrected()) {
    about = fmt::format(
        "the rig file was off by {:.2g} px in the right image ({:+.2f} px of disparity at "
        "infinity) "
        "and has been corrected; ",
        adjustment.correction_px, adjustment.infinity_offset_px);
  }
  if (rig.baseline_sigma_m) return about + "the baseline's sigma counted";
  return about + fmt::format("if the baseline is {:.2f} mm", 1000.0 * rig.Baseline());
}

// Beside the gates: how good the poses are, for the verdict.
Report ReportPart(const Gates& gates, const GateInputs& inputs, const PoseGateOptions& options) {
  const Accuracy accuracy = AccuracyOf(inputs.trajectory, inputs.adjustment, inputs.rig);
  const auto number = [](const std::optional<double>& value) {
    return value ? Report(*value) : Report(nullptr);
  };
  Report report = ReportGates(gates);
  report["verdict"] = {{"scale_95_pct", number(accuracy.scale_95_pct)},
                       {"position_95_m", number(accuracy.position_95_m)},
                       {"accuracy_asked_pct", options.accuracy_pct}};
  std::string text;
  if (accuracy.scale_95_pct && accuracy.position_95_m) {
    text = fmt::format("metres good to {:.2g} % and positions to {} (95 %); ",
                       *accuracy.scale_95_pct, Length(*accuracy.position_95_m));
  }
  report["verdict"]["text"] = text + AboutRig(inputs.rig, inputs.adjustment);
  report["depth_consistency"] = ReportDepthConsistency(inputs.depth_consistency);
  return report;
}

Report JudgeAdjusted(const Dataset& dataset, const FeatureIndex& features,
                     const KeyframeGraph& graph, const AlignedKeyframes& aligned,
                     const AdjustedPart& part, const MappingGateOptions& mapping,
                     const PoseGateOptions& poses, const AdjustmentGateOptions& adjustment,
                     const CalibrationGateOptions& calibration) {
  const bool was_mapped = graph.keyframes.size() >= kMinMappedKeyframes;
  const GateInputs inputs{dataset.rig,
                          part.odometry,
                          part.adjustment,
                          part.trajectory,
                          was_mapped ? &aligned : nullptr,
                          features.epipolar_px,
                          DepthConsistencyOf(part.adjustment)};
  return ReportPart(JudgePart(inputs, {mapping, poses, adjustment, calibration, {}}), inputs,
                    poses);
}

Report JudgeOdometric(const Dataset& dataset, const FeatureIndex& features,
                      const Odometry& odometry, const OdometricPart& part,
                      const MappingGateOptions& mapping, const PoseGateOptions& poses,
                      const AdjustmentGateOptions& adjustment,
                      const CalibrationGateOptions& calibration) {
  Adjustment none;
  none.world_from_left.resize(odometry.size());
  const GateInputs inputs{dataset.rig,     odometry, none,
                          part.trajectory, nullptr,  features.epipolar_px};
  return ReportPart(JudgePart(inputs, {mapping, poses, adjustment, calibration, {}}), inputs,
                    poses);
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

OdometricGatesCheck OdometricGates() {
  return {.name = "gates",
          .code = CodeHere(),
          .make = JudgeOdometric,
          .about = "the gates that apply to poses that nothing adjusted"};
}

DepthGatesCheck DepthGates() {
  return {.name = "depth_gates",
          .code = CodeHere(),
          .make = JudgeDepths,
          .about = "whether dense depth agrees with the sparse points"};
}

}  // namespace rigmap
