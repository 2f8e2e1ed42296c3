#include "gates/internal/motion_gates.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/statistics.h"
#include "gates/internal/step_differences.h"
#include "geometry/adjoint.h"

namespace rigmap {
namespace {

// How far off the steps of any few that follow each other are, in limits: a map that is torn or
// bent in one spot is off there alone. Sparse keyframes are torn in a single step: one by itself
// has to be as many times as far off, as one wrong motion of the odometry may be.
std::optional<double> WorstWindow(const std::vector<StepDifference>& differences,
                                  const AdjustmentGateOptions& options) {
  constexpr std::size_t kWindow = 3;
  std::optional<double> worst;
  for (const StepDifference& step : differences) {
    worst = std::max(worst.value_or(0.0), step.Excess(options) / kWindow);
  }
  for (std::size_t i = 0; i + kWindow <= differences.size(); ++i) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = i; k < i + kWindow; ++k) {
      least = std::min(least, differences[k].Excess(options));
    }
    worst = std::max(worst.value_or(0.0), least);
  }
  return worst;
}

// A way along the odometry's chain, from a frame that it was posed against, over others.
struct Way {
  int from = 0;
  Rigid3 odometric;                        // to_from_from
  Matrix6d covariance = Matrix6d::Zero();  // of it, as a left perturbation
  double length_m = 0.0;
};
// Of each frame, that which ends there; nothing where none does.
using Ways = std::vector<std::optional<Way>>;

Ways SingleSteps(const Odometry& odometry) {
  Ways ways(odometry.size());
  for (std::size_t i = 0; i < odometry.size(); ++i) {
    const OdometryFrame& frame = odometry[i];
    if (frame.source != PoseSource::kOdometry || frame.reference == static_cast<int>(i)) continue;
    const Rigid3 step = frame.world_from_left.Inverse() * odometry[frame.reference].world_from_left;
    ways[i] = {frame.reference, step, frame.step_covariance, step.translation.norm()};
  }
  return ways;
}

// Twice as many steps.
Ways Doubled(const Ways& ways) {
  Ways doubled(ways.size());
  for (std::size_t i = 0; i < ways.size(); ++i) {
    if (!ways[i] || !ways[ways[i]->from]) continue;
    const Way &last = *ways[i], &before = *ways[last.from];
    const Matrix6d carried = Adjoint(last.odometric);
    doubled[i] = {before.from, last.odometric * before.odometric,
                  last.covariance + carried * before.covariance * carried.transpose(),
                  last.length_m + before.length_m};
  }
  return doubled;
}

// Of the ways of `steps` steps, half differ by this and more, in limits.
std::optional<double> TypicalExcess(const Ways& ways, double steps, const GateInputs& inputs,
                                    const AdjustmentGateOptions& options, double accuracy_pct) {
  const double limit_pct = std::max(accuracy_pct, options.motion_agreement_pct / std::sqrt(steps));
  std::vector<double> excess;
  for (std::size_t i = 0; i < ways.size(); ++i) {
    if (!ways[i]) continue;
    const auto &to = inputs.adjustment.world_from_left[i],
               &from = inputs.adjustment.world_from_left[ways[i]->from];
    if (!to || !from) continue;
    const MotionDifference off =
        DifferenceOf(to->Inverse() * *from, ways[i]->odometric, ways[i]->covariance);
    const double pct = ways[i]->length_m > 0.0 ? 100.0 * off.distance_m / ways[i]->length_m : 0.0;
    excess.push_back(std::min(off.sigmas / options.motion_agreement_sigmas, pct / limit_pct));
  }
  return excess.empty() ? std::nullopt : std::optional(Median(std::move(excess)));
}

}  // namespace

// A step is as far off as the smaller of its two shares of the limits; the gates show the step
// that nine out of ten are better than.
void JudgeSteps(const GateInputs& inputs, const AdjustmentGateOptions& options, Gates& gates) {
  constexpr double kShare = 0.9;
  std::optional<double> sigmas, pct;
  auto differences = StepDifferences(inputs);
  gates.push_back(AtMost(
      "motion_agreement_window", WorstWindow(differences, options), 1.0,
      "three steps on end in which map and odometry differ, or one by three times as much, in "
      "limits of the two gates on all steps"));
  if (!differences.empty()) {
    const auto excess = [&](const StepDifference& step) { return step.Excess(options); };
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

Gate JudgeDrift(const GateInputs& inputs, const AdjustmentGateOptions& options,
                double accuracy_pct) {
  std::optional<double> worst;
  Ways ways = SingleSteps(inputs.odometry);
  // No chain has as many steps as there are frames, unless it goes round in a circle.
  for (std::size_t steps = 2; steps < inputs.odometry.size(); steps *= 2) {
    ways = Doubled(ways);
    const auto excess =
        TypicalExcess(ways, static_cast<double>(steps), inputs, options, accuracy_pct);
    if (excess) worst = std::max(worst.value_or(0.0), *excess);
  }
  return AtMost("motion_agreement_drift", worst, 1.0,
                "map against odometry over 2, 4, 8 and more steps, in limits that shrink with the "
                "root of their number, down to the accuracy asked for");
}

}  // namespace rigmap
