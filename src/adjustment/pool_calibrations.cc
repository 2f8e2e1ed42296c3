#include "adjustment/pool_calibrations.h"

#include <Eigen/Cholesky>

namespace rigmap {
namespace {

// The parts' equations at one correction for all: they are linear about their own.
CalibrationEquations EquationsAt(const CalibrationVector& correction,
                                 const std::vector<CalibrationWitness>& parts,
                                 const CalibrationWitness* left_out = nullptr) {
  CalibrationEquations sum;
  for (const CalibrationWitness& part : parts) {
    if (&part == left_out) continue;
    const CalibrationVector back = part.correction - correction;
    for (const CalibrationBlock& stretch : part.equations.stretches) {
      sum.stretches.push_back({stretch.score + stretch.information * back, stretch.information});
      sum.score += sum.stretches.back().score;
      sum.information += stretch.information;
    }
    sum.regions.resize(part.equations.regions.size());  // the same ones in all parts
    for (std::size_t i = 0; i < sum.regions.size(); ++i) {
      const CalibrationBlock& region = part.equations.regions[i];
      sum.regions[i].score += region.score + region.information * back;
      sum.regions[i].information += region.information;
    }
    sum.score_covariance += part.equations.score_covariance;
  }
  return sum;
}

struct Estimate {
  RigRefinement refined = RigRefinement::kNone;
  ProbableCorrection found;
};

std::optional<Estimate> EstimateOf(const std::vector<CalibrationWitness>& parts,
                                   const CalibrationWitness* left_out,
                                   const CalibrationPrior& prior,
                                   const AdjustmentOptions& counted) {
  Estimate estimate;
  CalibrationVector correction = CalibrationVector::Zero();
  for (bool settled = false; !settled;) {
    const CalibrationEquations equations = EquationsAt(correction, parts, left_out);
    const RigRefinement next =
        NextRefinement(estimate.refined, correction, equations, prior, counted);
    settled = next == estimate.refined || counted.refine_rig != RigRefinement::kAuto;
    estimate.refined = next;
    const auto probable = MostProbable(next, correction, equations, prior, counted);
    if (!probable) return std::nullopt;
    correction = probable->correction;
  }
  estimate.found = {correction, CalibrationErrorElsewhere(estimate.refined, correction,
                                                          EquationsAt(correction, parts, left_out),
                                                          prior, counted)};
  return estimate;
}

// What the parts say is as sure as it is: their correlations have been counted.
AdjustmentOptions Counted(const AdjustmentOptions& options) {
  AdjustmentOptions counted = options;
  counted.shared_noise = 1.0;
  return counted;
}

}  // namespace

std::optional<ProbableCorrection> PooledCorrection(const std::vector<CalibrationWitness>& parts,
                                                   const CalibrationPrior& prior,
                                                   const AdjustmentOptions& options) {
  const auto estimate = EstimateOf(parts, nullptr, prior, Counted(options));
  return estimate ? std::optional(estimate->found) : std::nullopt;
}

std::optional<PooledCalibration> PoolCalibrations(const std::vector<CalibrationWitness>& parts,
                                                  const CalibrationPrior& prior,
                                                  const AdjustmentOptions& options) {
  const AdjustmentOptions counted = Counted(options);
  const auto pooled = EstimateOf(parts, nullptr, prior, counted);
  if (!pooled) return std::nullopt;
  PooledCalibration result{pooled->refined, pooled->found, {}};
  const CalibrationVector& correction = result.pooled.correction;
  // Parts that contradict each other confirm nothing together: then all but the focal length is
  // compared.
  const RigRefinement compared =
      result.refined == RigRefinement::kNone ? RigRefinement::kAllButFocal : result.refined;
  for (const CalibrationWitness& part : parts) {
    const auto alone =
        MostProbable(compared, correction, EquationsAt(correction, {part}), prior, counted);
    const auto others =
        MostProbable(compared, correction, EquationsAt(correction, parts, &part), prior, counted);
    const auto without = EstimateOf(parts, &part, prior, counted);
    if (!alone || !others || !without) return std::nullopt;
    WitnessComparison comparison{*alone, *others, 0.0, without->found};
    CalibrationMatrix both = alone->covariance + others->covariance;
    const auto freed = static_cast<double>((both.diagonal().array() > 0.0).count());
    for (int i = 0; i < kCalibrationSize; ++i) {
      if (!(both(i, i) > 0.0)) both(i, i) = prior.sigmas(i) * prior.sigmas(i);
    }
    const CalibrationVector difference = alone->correction - others->correction;
    comparison.square_per_parameter =
        difference.dot(both.ldlt().solve(difference)) / std::max(1.0, freed);
    result.parts.push_back(comparison);
  }
  return result;
}

}  // namespace rigmap
