#include "gates/findings.h"

#include <algorithm>
#include <functional>

#include "gates/internal/step_differences.h"

namespace rigmap {
namespace {

constexpr int kLeastPiece = 3;  // frames

bool IsGuessed(const GateInputs& inputs, std::size_t frame) {
  return inputs.trajectory[frame].source == PoseSource::kPredicted;
}

bool InOneGroup(const Adjustment& adjustment, std::size_t a, std::size_t b) {
  return adjustment.world_from_left[a] && adjustment.world_from_left[b] &&
         !adjustment.datum_frames.empty() &&
         adjustment.datum_frames[a] == adjustment.datum_frames[b];
}

// Whether anything measured joins two frames that follow each other but for guessed ones.
bool IsJoined(const GateInputs& inputs, std::size_t before, std::size_t frame) {
  const OdometryFrame& step = inputs.odometry[frame];
  if (step.source == PoseSource::kOdometry && step.reference <= static_cast<int>(before)) {
    return true;
  }
  return InOneGroup(inputs.adjustment, before, frame);
}

void FindPieces(const GateInputs& inputs, const AdjustmentGateOptions& options,
                PartFindings& findings) {
  std::vector<bool> torn(inputs.trajectory.size(), false);
  for (const StepDifference& step : StepDifferences(inputs)) {
    if (!(step.Excess(options) <= 1.0)) torn[step.frame] = true;
  }
  for (const int frame : findings.breaks) torn[static_cast<std::size_t>(frame)] = true;
  std::vector<FrameRun>& pieces = findings.pieces;
  for (std::size_t i = 0; i < inputs.trajectory.size(); ++i) {
    if (IsGuessed(inputs, i)) continue;
    const int frame = static_cast<int>(i);
    if (pieces.empty() || torn[i]) pieces.push_back({frame, frame});
    pieces.back().end = frame + 1;
  }
  std::erase_if(pieces, [](const FrameRun& piece) { return piece.Count() < kLeastPiece; });
  std::ranges::stable_sort(pieces, std::greater(), &FrameRun::Count);
}

}  // namespace

int PartFindings::GuessedCount() const {
  int count = 0;
  for (const FrameRun& range : guessed) count += range.Count();
  return count;
}

std::optional<FrameRun> PartFindings::LongestMeasured() const {
  FrameRun longest;
  int first = 0;
  const auto take = [&](int end) {
    if (end - first > longest.Count()) longest = {first, end};
  };
  for (const FrameRun& range : guessed) {
    take(range.first);
    first = range.end;
  }
  take(frames);
  return longest.Count() >= kLeastPiece ? std::optional(longest) : std::nullopt;
}

std::vector<int> BreaksIn(const GateInputs& inputs) {
  std::vector<int> breaks;
  std::optional<std::size_t> before;
  for (std::size_t i = 0; i < inputs.trajectory.size(); ++i) {
    if (IsGuessed(inputs, i)) continue;
    if (before && !IsJoined(inputs, *before, i)) breaks.push_back(static_cast<int>(i));
    before = i;
  }
  return breaks;
}

BesideCovariances BesideCovariancesOf(const GateInputs& inputs) {
  BesideCovariances beside{.positions_known = inputs.positions_known,
                           .calibration_scale_sigma = inputs.calibration_scale_sigma};
  if (const auto& depths = inputs.depth_consistency) {
    // Of rings, each of which sees near and far: upper cells see what is too far for per cents.
    beside.depth_contradiction = depths->radius.depth_pct.value / 100.0;
  }
  return beside;
}

PartFindings FindingsOf(const GateInputs& inputs, const GateOptions& options) {
  PartFindings findings{.accuracy = AccuracyOf(inputs.trajectory, inputs.adjustment, inputs.rig,
                                               BesideCovariancesOf(inputs)),
                        .accuracy_asked_pct = options.poses.accuracy_pct,
                        .baseline_m = inputs.rig.Baseline(),
                        .frames = static_cast<int>(inputs.trajectory.size())};
  if (inputs.adjustment.IsRigCorrected()) {
    findings.rig_correction_px = inputs.adjustment.correction_px;
  }
  for (int frame = 0; frame < findings.frames; ++frame) {
    if (!IsGuessed(inputs, frame)) continue;
    auto& guessed = findings.guessed;
    if (guessed.empty() || guessed.back().end != frame) guessed.push_back({frame, frame});
    ++guessed.back().end;
    const Eigen::Matrix3d& covariance = inputs.trajectory[frame].position_covariance;
    findings.guessed_95_m = std::max(findings.guessed_95_m, Radius95(covariance));
  }
  findings.breaks = BreaksIn(inputs);
  for (std::size_t i = 1; i < inputs.odometry.size(); ++i) {
    const OdometryFrame& frame = inputs.odometry[i];
    const bool is_bridged =
        frame.bridged &&
        !InOneGroup(inputs.adjustment, static_cast<std::size_t>(frame.reference), i);
    if (is_bridged) findings.bridged.push_back(static_cast<int>(i));
  }
  FindPieces(inputs, options.adjustment, findings);
  return findings;
}

}  // namespace rigmap
