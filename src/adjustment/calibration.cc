#include "adjustment/calibration.h"

#include <spdlog/spdlog.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace rigmap {
namespace {

constexpr std::size_t kMinBlocks = 4;  // fewer cannot be trusted to contradict each other
// One block in so many may show something else: a person, a car, glare.
constexpr int kBlocksPerDissenter = 8;

// Which parameters are free.
CalibrationVector FreedBy(RigRefinement refined) {
  CalibrationVector freed = CalibrationVector::Zero();
  switch (refined) {
    case RigRefinement::kNone:
      break;
    case RigRefinement::kRotation:
      freed.segment<3>(kRotationX).setOnes();
      break;
    case RigRefinement::kRotationAndFocal:
      freed.segment<3>(kRotationX).setOnes();
      freed(kLogFocal) = 1.0;
      break;
    case RigRefinement::kAllButFocal:
      freed.setOnes();
      freed(kLogFocal) = 0.0;
      break;
    case RigRefinement::kAll:
    case RigRefinement::kAuto:
      freed.setOnes();
      break;
  }
  return freed;
}

struct LinearSystem {
  CalibrationMatrix matrix;
  CalibrationVector right_side;

  CalibrationVector Solution() const { return matrix.ldlt().solve(right_side); }
};

// Focal lengths err with a heavy tail: files are of another camera's, or of another focus.
// Student's t with three degrees of freedom about `now`: within a sigma as it is, far out it hardly
// pulls.
CalibrationMatrix HeavyTailed(const CalibrationPrior& prior, const CalibrationVector& now) {
  constexpr double kFreedom = 3.0;
  const double sigmas = now(kLogFocal) / prior.sigmas(kLogFocal);
  const double times = std::max(1.0, (kFreedom + sigmas * sigmas) / (kFreedom + 1.0));
  CalibrationMatrix information = prior.information;
  information.row(kLogFocal) /= std::sqrt(times);
  information.col(kLogFocal) /= std::sqrt(times);
  return information;
}

// Of the correction, not of a step from `now`. Held parameters stay where they are.
LinearSystem SystemOf(const CalibrationVector& freed, const CalibrationVector& now,
                      const CalibrationVector& score, const CalibrationMatrix& information,
                      double inflation, const CalibrationPrior& prior) {
  LinearSystem system{information / inflation, {}};
  system.right_side = system.matrix * now + score / inflation;
  system.matrix += HeavyTailed(prior, now);
  for (int i = 0; i < kCalibrationSize; ++i) {
    if (freed(i) != 0.0) continue;
    system.right_side -= system.matrix.col(i) * now(i);
    system.matrix.row(i).setZero();
    system.matrix.col(i).setZero();
    system.matrix(i, i) = 1.0;
    system.right_side(i) = now(i);
  }
  return system;
}

// The most probable correction by all observations but those of one block.
CalibrationVector WithoutBlock(const CalibrationVector& freed, const CalibrationVector& now,
                               const CalibrationEquations& equations,
                               const CalibrationBlock& left_out, double inflation,
                               const CalibrationPrior& prior) {
  return SystemOf(freed, now, equations.score - left_out.score,
                  equations.information - left_out.information, inflation, prior)
      .Solution();
}

}  // namespace

double Inflation(const CalibrationEquations& equations, const AdjustmentOptions& options) {
  const CalibrationMatrix ratio = equations.information.ldlt().solve(equations.score_covariance);
  const double mean = ratio.diagonal().mean();
  return (std::isfinite(mean) ? std::max(1.0, mean) : 1.0) * options.shared_noise *
         options.shared_noise;
}

CalibrationPrior AsGoodAsFound(const CalibrationPrior& prior, const CalibrationVector& now,
                               const CalibrationEquations& equations,
                               const AdjustmentOptions& options) {
  constexpr double kFreedom = 5.0;
  constexpr int kIterations = 20;
  const double inflation = Inflation(equations, options);
  const CalibrationVector freed = FreedBy(RigRefinement::kAllButFocal);
  // Of all but the focal length, whatever that may be.
  const CalibrationVector with_focal = prior.information.col(kLogFocal);
  const CalibrationMatrix marginal =
      prior.information - with_focal * with_focal.transpose() / with_focal(kLogFocal);
  double times = 1.0;
  for (int i = 0; i < kIterations; ++i) {
    const LinearSystem system = SystemOf(freed, now, equations.score, equations.information,
                                         inflation, {prior.sigmas, marginal / times});
    const CalibrationVector found = system.Solution();
    const double told =
        freed.sum() - (marginal / times * system.matrix.inverse()).trace();  // parameters
    const double squares = found.dot(marginal * found);
    const double better = (kFreedom + squares) / (kFreedom + std::max(0.0, told));
    if (!std::isfinite(better)) return prior;
    times = better;
  }
  return {prior.sigmas * std::sqrt(times), prior.information / times};
}

std::optional<ProbableCorrection> MostProbable(RigRefinement refined, const CalibrationVector& now,
                                               const CalibrationEquations& equations,
                                               const CalibrationPrior& prior,
                                               const AdjustmentOptions& options) {
  const CalibrationVector freed = FreedBy(refined);
  const LinearSystem system = SystemOf(freed, now, equations.score, equations.information,
                                       Inflation(equations, options), prior);
  ProbableCorrection found{system.Solution(), system.matrix.inverse()};
  if (!found.correction.allFinite() || !found.covariance.allFinite()) return std::nullopt;
  found.covariance = freed.asDiagonal() * found.covariance * freed.asDiagonal();
  return found;
}

std::optional<LeftOutGain> GainOfRefining(RigRefinement from, RigRefinement to,
                                          const CalibrationVector& now,
                                          const CalibrationEquations& equations,
                                          const std::vector<CalibrationBlock>& blocks,
                                          const CalibrationPrior& prior,
                                          const AdjustmentOptions& options) {
  if (blocks.size() < kMinBlocks) return std::nullopt;
  const double inflation = Inflation(equations, options);
  LeftOutGain found{.blocks = static_cast<int>(blocks.size())};
  for (const CalibrationBlock& left_out : blocks) {
    const auto gain_of = [&](RigRefinement refined) {
      const CalibrationVector step =
          WithoutBlock(FreedBy(refined), now, equations, left_out, inflation, prior) - now;
      return left_out.score.dot(step) - 0.5 * step.dot(left_out.information * step);
    };
    const double gain = (gain_of(to) - gain_of(from)) / inflation;
    if (!std::isfinite(gain)) return std::nullopt;
    found.Add(gain);
  }
  return found;
}

namespace {

// Of what is left out the focal length must explain at least half of what it would if it were that
// one, and all else as modelled.
double HalfOfExpectedGain(double asked, const ProbableCorrection& all) {
  return 0.25 * asked * asked / all.covariance(kLogFocal, kLogFocal);
}

// Whether the images ask for a focal length that left-out stretches or regions contradict, or that
// is not followed because the lens is known to differ from its model. Where the former agree, if
// not by enough to follow them, what is asked for is known as it says.
bool IsFocalRejected(RigRefinement refined, const CalibrationVector& now,
                     const ProbableCorrection& all, const CalibrationEquations& equations,
                     const CalibrationPrior& prior, const AdjustmentOptions& options) {
  constexpr double kConflictSigmas = 2.0;
  const double asked = std::abs(all.correction(kLogFocal) - now(kLogFocal));
  if (refined != RigRefinement::kAllButFocal || options.refine_rig != RigRefinement::kAuto ||
      asked <= kConflictSigmas * std::sqrt(all.covariance(kLogFocal, kLogFocal))) {
    return false;
  }
  const double least_gain = HalfOfExpectedGain(asked, all);
  const auto contradicts = [&](const std::vector<CalibrationBlock>& blocks) {
    const auto gain =
        GainOfRefining(refined, RigRefinement::kAll, now, equations, blocks, prior, options);
    return !gain || gain->sum < least_gain || gain->against > gain->blocks / kBlocksPerDissenter;
  };
  return equations.HasField() || contradicts(equations.stretches) || contradicts(equations.regions);
}

// Delete-one jackknife over the regions of the image: what all stretches have in common, as a lens
// that its model does not describe, differs between these. About what all regions together say:
// about the prior's mean, what one region alone tells would go back to the file without it, and
// take the focal length along, though all agree.
double FocalVarianceOverRegions(const CalibrationVector& now, const CalibrationEquations& equations,
                                const CalibrationPrior& prior, const AdjustmentOptions& options) {
  const auto count = static_cast<double>(equations.regions.size());
  const double inflation = Inflation(equations, options);
  const CalibrationMatrix prior_information = inflation * HeavyTailed(prior, now);
  const CalibrationVector told = equations.information.ldlt().solve(equations.score);
  double sum = 0.0, squares = 0.0;
  for (const CalibrationBlock& left_out : equations.regions) {
    const LinearSystem others{equations.information - left_out.information + prior_information,
                              left_out.information * told - left_out.score};
    const double found = others.Solution()(kLogFocal);
    sum += found;
    squares += found * found;
  }
  if (equations.regions.empty() || !std::isfinite(squares)) return 0.0;
  return std::max(0.0, (count - 1.0) * (squares / count - (sum / count) * (sum / count)));
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
  if (!IsFocalRejected(refined, now, *all, equations, prior, options)) {
    const double unlike = FocalVarianceOverRegions(now, equations, prior, options);
    return held + std::max(variance, unlike) * by_focal + off * off.transpose();
  }
  const CalibrationVector off_held = off - off(kLogFocal) * following;
  // What they ask for is the error of the focal length, what makes them ask besides, and noise.
  // Nothing tells how it is divided between the former two: in the mean half of the square that
  // noise does not explain is either's. If they are right all the same, it is two sigmas away at
  // most.
  constexpr double kMostSigmas = 2.0;
  const double asked = std::abs(off(kLogFocal));
  const double share = std::sqrt(0.5 * std::max(0.0, asked * asked - variance));
  const double sigma = std::max(asked / kMostSigmas, std::min(prior.sigmas(kLogFocal), share));
  return held + off_held * off_held.transpose() + sigma * sigma * by_focal;
}

CalibrationMatrix CalibrationErrorElsewhere(RigRefinement refined, const CalibrationVector& now,
                                            const CalibrationEquations& equations,
                                            const CalibrationPrior& prior,
                                            const AdjustmentOptions& options) {
  CalibrationMatrix error = CalibrationError(refined, now, equations, prior, options);
  const auto all = MostProbable(RigRefinement::kAll, now, equations, prior, options);
  if (!all || !IsFocalRejected(refined, now, *all, equations, prior, options)) return error;
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
  const auto correction = MostProbable(next, now, equations, prior, options);
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
        "rig refined by {} instead of {}: stretches left out gain {:.1f}, {} of {} against",
        NameOf(next), NameOf(refined), gain->sum, gain->against, gain->blocks);
    // Of six already where it is not the scale that is asked for.
    const int per_dissenter = next == RigRefinement::kAllButFocal ? 6 : kBlocksPerDissenter;
    return gain->sum > least_gain && gain->against <= gain->blocks / per_dissenter;
  };
  const auto do_regions_confirm = [&] {
    const auto gain =
        GainOfRefining(refined, next, now, equations, equations.regions, prior, options);
    if (!gain) return false;
    const double sigma = std::sqrt(FocalVarianceOverRegions(now, equations, prior, options));
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
