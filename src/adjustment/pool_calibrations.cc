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
    const auto here = [&](const CalibrationBlock& block) {
      return CalibrationBlock{block.score + block.information * back, block.information};
    };
    for (const CalibrationBlock& stretch : part.equations.stretches) {
      sum.stretches.push_back(here(stretch));
    }
    sum.regions.resize(part.equations.regions.size());  // the same ones in all parts
    for (std::size_t i = 0; i < sum.regions.size(); ++i) {
      sum.regions[i] += here(part.equations.regions[i]);
    }
    sum.of_field += here(part.equations.of_field);
    sum.score_covariance += part.equations.score_covariance;
  }
  sum.AddUp();
  return sum;
}

struct Estimate {
  RigRefinement refined = RigRefinement::kNone;
  ProbableCorrection found;
};

std::optional<Estimate> EstimateOf(const std::vector<CalibrationWitness>& parts,
                                   const CalibrationWitness* left_out,
                                   const CalibrationPrior& usual,
                                   const AdjustmentOptions& counted) {
  Estimate estimate;
  CalibrationVector correction = CalibrationVector::Zero();
  CalibrationPrior prior;
  for (bool settled = false; !settled;) {
    const CalibrationEquations equations = EquationsAt(correction, parts, left_out);
    prior = AsGoodAsFound(usual, correction, equations, counted);
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

// What they say of the parameters of `compared`, and how sure it is of what others say.
std::optional<Estimate> ComparedEstimate(RigRefinement compared,
                                         const std::vector<CalibrationWitness>& parts,
                                         const CalibrationWitness* left_out,
                                         const CalibrationVector& about,
                                         const CalibrationPrior& prior,
                                         const AdjustmentOptions& counted) {
  const auto probable =
      MostProbable(compared, about, EquationsAt(about, parts, left_out), prior, counted);
  if (!probable) return std::nullopt;
  const CalibrationVector& found = probable->correction;
  return Estimate{
      compared,
      {found, CalibrationErrorElsewhere(compared, found, EquationsAt(found, parts, left_out), prior,
                                        counted)}};
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
    const auto alone = ComparedEstimate(compared, {part}, nullptr, correction, prior, counted);
    const auto others = ComparedEstimate(compared, parts, &part, correction, prior, counted);
    const auto without = EstimateOf(parts, &part, prior, counted);
    if (!alone || !others || !without) return std::nullopt;
    WitnessComparison comparison{alone->found, others->found, 0.0, without->found};
    const CalibrationMatrix both = alone->found.covariance + others->found.covariance;
    const CalibrationVector difference = alone->found.correction - others->found.correction;
    const auto freed = static_cast<double>((difference.array() != 0.0).count());
    comparison.square_per_parameter =
        difference.dot(both.ldlt().solve(difference)) / std::max(1.0, freed);
    result.parts.push_back(comparison);
  }
  return result;
}

}  // namespace rigmap
