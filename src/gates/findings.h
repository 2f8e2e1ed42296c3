// What is known of a part beside its gates, for telling why it is refused and what of it is usable.
#pragma once

#include <optional>
#include <vector>

#include "gates/accuracy.h"
#include "gates/gates.h"

namespace rigmap {

// Frames FIRST:END of a part, END excluded, as --frames has them.
struct FrameRun {
  int first = 0, end = 0;

  int Count() const { return end - first; }
  bool operator==(const FrameRun&) const = default;
};

struct PartFindings {
  Accuracy accuracy;
  double accuracy_asked_pct = 1.0;
  double baseline_m = 0.0;  // as the rig file has it; 0: the metres are not of the images
  // By how much the images corrected the rig file, in the right image; nothing if they did not.
  std::optional<double> rig_correction_px;
  int frames = 0;
  std::vector<FrameRun> guessed;  // whose pose is a prediction, in order
  double guessed_95_m = 0.0;      // the worst of them: radius that holds the truth with 95 %
  std::vector<int> breaks;        // frames that nothing measured joins to those before
  std::vector<int> bridged;       // frames that only the rover's sensors join to those before
  // Runs of three frames and more in which each is joined to those before by what was measured, and
  // map and odometry tell of the same step; the longest first.
  std::vector<FrameRun> pieces;

  int GuessedCount() const;
  // The longest run of frames that are not, if it has three.
  std::optional<FrameRun> LongestMeasured() const;
};

// Frames of the trajectory that nothing measured joins to those before: where they lie is a guess
// that all behind them share.
std::vector<int> BreaksIn(const GateInputs& inputs);

// What the gates know of lengths that the trajectory's covariances do not.
BesideCovariances BesideCovariancesOf(const GateInputs& inputs);

PartFindings FindingsOf(const GateInputs& inputs, const GateOptions& options);

}  // namespace rigmap
