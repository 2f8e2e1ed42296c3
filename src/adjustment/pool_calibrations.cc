#include "adjustment/pool_calibrations.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

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

// Whether a part holds its focal length beside a field of the lens, as single parts do: the common
// one, however many agree, is then what the lens model lacks.
bool IsFocalHeldByAField(const std::vector<CalibrationWitness>& parts,
                         const CalibrationWitness* left_out) {
  return std::ranges::any_of(parts, [=](const CalibrationWitness& part) {
    return &part != left_out && part.equations.HasField() && part.correction(kLogFocal) == 0.0;
  });
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
    RigRefinement next = NextRefinement(estimate.refined, correction, equations, prior, counted);
    if (counted.refine_rig == RigRefinement::kAuto && IsFocalHeldByAField(parts, left_out)) {
      next = std::min(next, RigRefinement::kAllButFocal);
    }
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

// How far a part is from all others, in the parameters that are free.
struct Difference {
  double square = 0.0;    // in units of what both leave unknown
  double free = 0.0;      // parameters
  double largest = 0.0;   // of one of them, in sigmas
  double response = 0.0;  // of the square to rigs that differ by the prior
};

Difference DifferenceOf(const WitnessComparison& part, const CalibrationMatrix& usual) {
  const CalibrationVector apart = part.alone.correction - part.others.correction;
  const CalibrationMatrix unknown = part.alone.covariance + part.others.covariance;
  const auto both = unknown.ldlt();
  CalibrationMatrix free = CalibrationMatrix::Zero();
  double largest = 0.0;
  for (int i = 0; i < kCalibrationSize; ++i) {
    if (apart(i) == 0.0) continue;
    free(i, i) = 1.0;
    largest = std::max(largest, std::abs(apart(i)) / std::sqrt(unknown(i, i)));
  }
  return {apart.dot(both.solve(apart)), free.trace(), largest,
          both.solve(free * usual * free).eval().trace()};
}

// By how much the sum of the squares of as many parts of one rig exceeds its mean in one of twenty
// cases: without such a limit chance alone would take a fifth of what they tell.
double ByChance(double free, double parts) {
  constexpr double kOneOfTwenty = 1.645;
  // Each part is compared with the mean of all others, so that one of them is told by the rest.
  const double independent = free * (parts - 1.0) / parts;
  return kOneOfTwenty * std::sqrt(2.0 * independent) * parts / (parts - 1.0);
}

// What the variance between parts adds for one that is not among those pooled. A rig gives as much,
// in units of what rig files are usually off by, in all parameters.
void AddWhatRigsGive(const CalibrationMatrix& usual, PooledCalibration& pooled) {
  const auto count = static_cast<double>(pooled.parts.size());
  if (pooled.parts.size() < 2) return;
  Difference sum;
  for (const WitnessComparison& part : pooled.parts) {
    const Difference difference = DifferenceOf(part, usual);
    sum.square += difference.square;
    sum.free += difference.free;
    sum.response += difference.response;
  }
  if (sum.square <= sum.free + ByChance(sum.free, count) || sum.response <= 0.0) return;
  // The mean of all others gives as well, by one part's share of it.
  const double of_usual = (sum.square - sum.free) / sum.response * (count - 1.0) / count;
  pooled.between = of_usual * usual;
  pooled.pooled.covariance += (1.0 + 1.0 / count) * pooled.between;
  for (WitnessComparison& part : pooled.parts) {
    part.without.covariance += (1.0 + 1.0 / (count - 1.0)) * pooled.between;
  }
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
  const CalibrationMatrix usual = prior.information.ldlt().solve(CalibrationMatrix::Identity());
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
    WitnessComparison comparison{
        .alone = alone->found, .others = others->found, .without = without->found};
    const Difference difference = DifferenceOf(comparison, usual);
    comparison.square_per_parameter = difference.square / std::max(1.0, difference.free);
    comparison.largest_sigmas = difference.largest;
    result.parts.push_back(comparison);
  }
  AddWhatRigsGive(usual, result);
  return result;
}

}  // namespace rigmap
