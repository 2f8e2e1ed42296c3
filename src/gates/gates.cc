#include "gates/gates.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/statistics.h"
#include "gates/accuracy.h"
#include "gates/findings.h"
#include "gates/internal/motion_gates.h"

namespace rigmap {
namespace {

void JudgePrediction(const GateInputs& inputs, const PoseGateOptions& options, Gates& gates) {
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

void JudgeBreaks(const GateInputs& inputs, const PoseGateOptions& options, Gates& gates) {
  std::optional<double> breaks;
  if (!inputs.odometry.empty()) breaks = static_cast<double>(BreaksIn(inputs).size());
  gates.push_back(AtMost("breaks", breaks, options.breaks,
                         "how often nothing measured joins a frame to those before it"));
}

void JudgeAccuracy(const GateInputs& inputs, const PoseGateOptions& options, Gates& gates) {
  const Accuracy accuracy =
      AccuracyOf(inputs.trajectory, inputs.adjustment, inputs.rig, BesideCovariancesOf(inputs));
  gates.push_back(AtMost("scale_95_pct", accuracy.scale_95_pct, options.accuracy_pct,
                         "the scale is known to so many per cent (95 %) only"));
  gates.push_back(
      AtMost("position_95_pct", accuracy.position_95_pct, options.accuracy_pct,
             "positions are known to so many per cent (95 %) of the path, or of a metre "
             "if that is longer, only"));
}

}  // namespace

Gate AtMost(std::string name, std::optional<double> value, double limit, std::string why) {
  return {std::move(name), value, limit, !value || *value <= limit, std::move(why)};
}

void AddEither(Gate a, Gate b, Gates& gates) {
  a.passed = b.passed = a.passed || b.passed;
  gates.push_back(std::move(a));
  gates.push_back(std::move(b));
}

std::optional<MappedShape> ShapeOf(const AlignedKeyframes* aligned) {
  if (!aligned) return std::nullopt;
  MappedShape shape;
  std::size_t used = 0, off = 0;
  for (const AlignedModel& model : aligned->models) {
    shape.baseline_spread =
        std::max(shape.baseline_spread.value_or(0.0), model.scale.relative_spread);
    used += model.scale.pairs_used.size();
    off += model.scale.pairs_rejected.size();
  }
  shape.baseline_rejected =
      static_cast<double>(off) / std::max<double>(1.0, static_cast<double>(used + off));
  const auto& poses = aligned->world_from_left;
  const auto posed =
      std::ranges::count_if(poses, [](const auto& pose) { return pose.has_value(); });
  shape.registered = static_cast<double>(posed) / static_cast<double>(poses.size());
  return shape;
}

Gates JudgeMapping(const std::optional<MappedShape>& shape, const MappingGateOptions& options) {
  const auto spread = shape ? shape->baseline_spread : std::nullopt;
  const auto rejected = shape ? std::optional(shape->baseline_rejected) : std::nullopt;
  const auto registered = shape ? std::optional(shape->registered) : std::nullopt;
  Gates gates;
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

Gates JudgeAdjustment(const GateInputs& inputs, const AdjustmentGateOptions& options) {
  Gates gates;
  JudgeSteps(inputs, options, gates);
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

Gates JudgePoses(const GateInputs& inputs, const PoseGateOptions& options) {
  Gates gates;
  JudgePrediction(inputs, options, gates);
  JudgeBreaks(inputs, options, gates);
  JudgeAccuracy(inputs, options, gates);
  return gates;
}

Gate JudgeDepthConsistency(const std::optional<DepthConsistency>& consistency,
                           const PoseGateOptions& options) {
  constexpr double kSigmas = 2.0;
  const auto at_least = [](const DepthPartition* partition) {
    return partition->depth_pct.value - kSigmas * partition->depth_pct.sigma;
  };
  Gate gate = AtMost("depth_consistency_pct", std::nullopt, options.accuracy_pct,
                     "too little is seen to compare stereo with temporal depth");
  if (!consistency) return gate;
  const DepthPartition* worse =
      std::max(&consistency->radius, &consistency->cells,
               [&](const auto* a, const auto* b) { return at_least(a) < at_least(b); });
  gate.value = worse->depth_pct.value;
  gate.passed = at_least(worse) <= options.accuracy_pct;
  gate.why = fmt::format(
      "stereo and temporal depth differ from one {} of the image to another, by {:.2g} +- {:.2g} % "
      "or {:.2g} px of disparity beyond noise",
      worse == &consistency->radius ? "ring" : "cell", worse->depth_pct.value,
      worse->depth_pct.sigma, worse->disparity_px.value);
  return gate;
}

Gates JudgePart(const GateInputs& inputs, const GateOptions& options) {
  Gates gates = JudgeMapping(ShapeOf(inputs.aligned), options.mapping);
  for (Gate& gate : gates) {
    if (gate.passed || inputs.rests_on_mapping) continue;
    gate.passed = true;
    gate.why += " (a diagnostic: the adjustment began from the odometry)";
  }
  for (const Gates& more :
       {JudgePoses(inputs, options.poses), JudgeAdjustment(inputs, options.adjustment),
        JudgeCalibration(inputs, options.calibration)}) {
    gates.insert(gates.end(), more.begin(), more.end());
  }
  gates.push_back(JudgeDrift(inputs, options.adjustment, options.poses.accuracy_pct));
  gates.push_back(JudgeDepthConsistency(inputs.depth_consistency, options.poses));
  return gates;
}

Gate JudgeDepthBias(std::optional<double> bias_px, const DepthGateOptions& options) {
  const auto size_px = bias_px ? std::optional(std::abs(*bias_px)) : std::nullopt;
  return AtMost("depth_bias_px", size_px, options.depth_bias_px,
                "median disparity of dense matching minus that of sparse points");
}

std::string FigureText(const Gate& gate) {
  // A value that is not finite cannot stand in JSON: read back it is missing.
  const std::string value = gate.value ? fmt::format("{:.4g}", *gate.value) : "not a number";
  return fmt::format("gate {} is {}, limit {:.4g}", gate.name, value, gate.limit);
}

std::string FailureReason(const Gates& gates) {
  std::vector<std::string> failed;
  const std::string* said = nullptr;
  for (const Gate& gate : gates) {
    // Of two gates on one thing the first speaks for both.
    if (gate.passed || (said && gate.why == *said)) continue;
    said = &gate.why;
    failed.push_back(fmt::format("{}: {}", FigureText(gate), gate.why));
  }
  return fmt::format("{}", fmt::join(failed, "; "));
}

}  // namespace rigmap
