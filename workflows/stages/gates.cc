#include "workflows/stages/gates.h"

#include "pipeline/code_identity.h"
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

Report JudgeAdjusted(const Dataset& dataset, const FeatureIndex& features,
                     const KeyframeGraph& graph, const AlignedKeyframes& aligned,
                     const AdjustedPart& part, const MappingGateOptions& mapping,
                     const PoseGateOptions& poses, const AdjustmentGateOptions& adjustment,
                     const CalibrationGateOptions& calibration) {
  const bool was_mapped = graph.keyframes.size() >= kMinMappedKeyframes;
  return ReportGates(JudgePart({dataset.rig, part.odometry, part.adjustment, part.trajectory,
                                was_mapped ? &aligned : nullptr, features.epipolar_px},
                               {mapping, poses, adjustment, calibration, {}}));
}

Report JudgeOdometric(const Dataset& dataset, const FeatureIndex& features,
                      const Odometry& odometry, const OdometricPart& part,
                      const MappingGateOptions& mapping, const PoseGateOptions& poses,
                      const AdjustmentGateOptions& adjustment,
                      const CalibrationGateOptions& calibration) {
  Adjustment none;
  none.world_from_left.resize(odometry.size());
  return ReportGates(
      JudgePart({dataset.rig, odometry, none, part.trajectory, nullptr, features.epipolar_px},
                {mapping, poses, adjustment, calibration, {}}));
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
