#include <spdlog/spdlog.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "adjustment/calibration.h"
#include "adjustment/internal/calibration_system.h"

namespace rigmap {
namespace {

// One block in so many may show something else: a person, a car, glare.
constexpr int kBlocksPerDissenter = 8;

// Of what is left out the focal length must explain at least half of what it would if it were that
// one, and all else as modelled.
double HalfOfExpectedGain(double asked, const ProbableCorrection& all) {
  return 0.25 * asked * asked / all.covariance(kLogFocal, kLogFocal);
}

// Whether the images ask for a focal length that left-out stretches or regions contradict, or that
// is not followed, however little it is, because the lens is known to differ from its model. Where
// the former agree, if not by enough to follow them, what is asked for is known as it says.
bool IsFocalRejected(RigRefinement refined, const CalibrationVector& now,
                     const CalibrationEquations& equations, const CalibrationPrior& prior,
                     const AdjustmentOptions& options) {
  constexpr double kConflictSigmas = 2.0;
  if (refined != RigRefinement::kAllButFocal || options.refine_rig != RigRefinement::kAuto) {
    return false;
  }
  if (equations.HasField()) return true;
  const auto all = MostProbable(RigRefinement::kAll, now, equations, prior,
                                InflationOfPoses(equations, options));
  if (!all) return false;
  const double asked = std::abs(all->correction(kLogFocal) - now(kLogFocal));
  if (asked <= kConflictSigmas * std::sqrt(all->covariance(kLogFocal, kLogFocal))) return false;
  const double least_gain = HalfOfExpectedGain(asked, *all);
  const auto contradicts = [&](const std::vector<CalibrationBlock>& blocks) {
    const auto gain =
        GainOfRefining(refined, RigRefinement::kAll, now, equations, blocks, prior, options);
    return !gain || gain->sum < least_gain || gain->against > gain->blocks / kBlocksPerDissenter;
  };
  return contradicts(equations.stretches) || contradicts(equations.regions);
}

// Delete-one jackknife over the regions of the image: what all stretches have in common, as a lens
// that its model does not describe, differs between these. About what all regions together say:
// about the prior's mean, what one region alone tells would go back to the file without it, and
// take the focal length along, though all agree.
double FocalVarianceOverRegions(const CalibrationVector& now, const CalibrationEquations& equations,
                                const CalibrationPrior& prior, double inflation) {
  const auto count = static_cast<double>(equations.regions.size());
  const CalibrationMatrix prior_information = inflation * HeavyTailed(prior, now);
  const CalibrationVector told = equations.information.ldlt().solve(equations.score);
  double sum = 0.0, squares = 0.0;
  for (const CalibrationBlock& left_out : equations.regions) {
    const CalibrationSystem others{equations.information - left_out.information + prior_information,
                                   left_out.information * told - left_out.score};
    const double found = others.Solution()(kLogFocal);
    sum += found;
    squares += found * found;
  }
  if (equations.regions.empty() || !std::isfinite(squares)) return 0.0;
  return std::max(0.0, (count - 1.0) * (squares / count - (sum / count) * (sum / count)));
}

// What images ask for is the error of the focal length, what makes them ask besides, and noise of
// this variance. Nothing tells how it is divided between the former two: both are as likely, each
// with half of the square that noise does not explain. The error then lies about half of what
// is asked, a little less for the noise; of a normal one about zero with the same 95 per cent, this
// is the variance.
double SquareOfErrorWithin(double asked, double variance) {
  constexpr double kOf95 = 1.96;
  constexpr int kHalvings = 40;
  const double either = 0.5 * (asked * asked - variance);
  if (!(either > 0.0)) return 0.0;
  const double mean = asked * either / (2.0 * either + variance);
  const double deviation = std::sqrt(either * (either + variance) / (2.0 * either + variance));
  const auto above = [&](double bound) {
    return 0.5 * std::erfc(bound / deviation / std::numbers::sqrt2);
  };
  double low = 0.0, high = mean + 4.0 * deviation;
  for (int i = 0; i < kHalvings; ++i) {
    const double bound = 0.5 * (low + high);
    (above(bound - mean) + above(bound + mean) > 0.05 ? low : high) = bound;
  }
  return high * high / (kOf95 * kOf95);
}

// What the others would do if the focal length were another one.
CalibrationVector FollowingFocal(const CalibrationMatrix& covariance) {
  return covariance.col(kLogFocal) / covariance(kLogFocal, kLogFocal);
}

}  // namespace

CalibrationMatrix CalibrationError(RigRefinement refined, const CalibrationVector& now,
                                   const CalibrationEquations& equations,
                                   const CalibrationPrior& prior,
                                   const AdjustmentOptions& options) {
  const auto all = MostProbable(RigRefinement::kAll, now, equations, prior, options);
  if (!all) return prior.sigmas.cwiseAbs2().asDiagonal();
  const CalibrationVector off = all->correction - now;
  const CalibrationVector following = FollowingFocal(all->covariance);
  const double variance = all->covariance(kLogFocal, kLogFocal);
  const CalibrationMatrix by_focal = following * following.transpose();
  const CalibrationMatrix held = all->covariance - variance * by_focal;
  if (!IsFocalRejected(refined, now, equations, prior, options)) {
    const double unlike =
        FocalVarianceOverRegions(now, equations, prior, Inflation(equations, options));
    return held + std::max(variance, unlike) * by_focal + off * off.transpose();
  }
  const CalibrationVector off_held = off - off(kLogFocal) * following;
  // Of what noise may have cancelled by chance no less than kLeast counts. If they are right all
  // the same, it is two sigmas away at most.
  constexpr double kMostSigmas = 2.0, kLeast = 2.5;  // the latter of the noise's variance
  const double asked = std::abs(off(kLogFocal)), square = asked * asked;
  const double share = std::min(square + variance,
                                std::max(SquareOfErrorWithin(asked, variance), kLeast * variance));
  const double sigma =
      std::max(asked / kMostSigmas, std::min(prior.sigmas(kLogFocal), std::sqrt(share)));
  return held + off_held * off_held.transpose() + sigma * sigma * by_focal;
}

CalibrationMatrix CalibrationErrorElsewhere(RigRefinement refined, const CalibrationVector& now,
                                            const CalibrationEquations& equations,
                                            const CalibrationPrior& prior,
                                            const AdjustmentOptions& options) {
  CalibrationMatrix error = CalibrationError(refined, now, equations, prior, options);
  const auto all = MostProbable(RigRefinement::kAll, now, equations, prior, options);
  if (!all || !IsFocalRejected(refined, now, equations, prior, options)) return error;
  CalibrationVector followed =
      (all->correction(kLogFocal) - now(kLogFocal)) * FollowingFocal(all->covariance);
  followed(kLogFocal) = 0.0;
  error += followed * followed.transpose();
  return error;
}

RigRefinement NextRefinement(RigRefinement refined, const CalibrationVector& now,
                             const CalibrationEquations& equations, const CalibrationPrior& prior,
                             const AdjustmentOptions& options) {
  if (options.refine_rig != RigRefinement::kAuto) return options.refine_rig;
  if (refined == RigRefinement::kAll) return refined;
  const RigRefinement next =
      refined == RigRefinement::kNone ? RigRefinement::kAllButFocal : RigRefinement::kAll;
  const double inflation = InflationOfPoses(equations, options);
  const auto correction = MostProbable(next, now, equations, prior, inflation);
  if (!correction) return refined;
  double least_gain = 0.5 * options.refine_sigmas * options.refine_sigmas;
  const double asked = std::abs(correction->correction(kLogFocal) - now(kLogFocal));
  if (next == RigRefinement::kAll) {
    least_gain = std::max(least_gain, HalfOfExpectedGain(asked, *correction));
  }
  const auto do_stretches_confirm = [&] {
    const auto gain =
        GainOfRefining(refined, next, now, equations, equations.stretches, prior, options);
    if (!gain) return false;
    spdlog::info(
        "rig refined by {} instead of {}? Stretches left out would gain {:.1f}, {} of {} against",
        NameOf(next), NameOf(refined), gain->sum, gain->against, gain->blocks);
    // Of six already where it is not the scale that is asked for.
    const int per_dissenter = next == RigRefinement::kAllButFocal ? 6 : kBlocksPerDissenter;
    return gain->sum > least_gain && gain->against <= gain->blocks / per_dissenter;
  };
  const auto do_regions_confirm = [&] {
    const auto gain =
        GainOfRefining(refined, next, now, equations, equations.regions, prior, options);
    if (!gain) return false;
    const double sigma = std::sqrt(FocalVarianceOverRegions(now, equations, prior, inflation));
    spdlog::info("a focal length other by {:.3f} %: regions left out gain {:.1f}, sigma {:.3f} %",
                 100.0 * asked, gain->sum, 100.0 * sigma);
    return gain->sum > least_gain && asked > options.refine_sigmas * sigma;
  };
  // Over long paths the least noise that all frames share becomes significant.
  constexpr double kMattersPriorSigmas = 0.05;  // 0.005 degrees, 0.025 %, 0.05 px
  const bool matters =
      ((correction->correction - now).cwiseQuotient(prior.sigmas).cwiseAbs().array() >
       kMattersPriorSigmas)
          .any();
  const bool is_confirmed =
      do_stretches_confirm() && (next == RigRefinement::kAllButFocal || do_regions_confirm());
  return matters && is_confirmed ? next : refined;
}

}  // namespace rigmap
