#include "adjustment/calibration.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "adjustment/internal/calibration_system.h"

namespace rigmap {
namespace {

constexpr std::size_t kMinBlocks = 4;  // fewer cannot be trusted to contradict each other

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

// Of the correction, not of a step from `now`. Held parameters stay where they are.
CalibrationSystem SystemOf(const CalibrationVector& freed, const CalibrationVector& now,
                           const CalibrationVector& score, const CalibrationMatrix& information,
                           double inflation, const CalibrationPrior& prior) {
  CalibrationSystem system{information / inflation, {}};
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

CalibrationMatrix HeavyTailed(const CalibrationPrior& prior, const CalibrationVector& now) {
  constexpr double kFreedom = 3.0;
  CalibrationMatrix information = prior.information;
  for (const CalibrationParameter parameter : {kLogFocal, kLogAspect}) {
    const double sigmas = now(parameter) / prior.sigmas(parameter);
    const double times = std::max(1.0, (kFreedom + sigmas * sigmas) / (kFreedom + 1.0));
    information.row(parameter) /= std::sqrt(times);
    information.col(parameter) /= std::sqrt(times);
  }
  return information;
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
    const CalibrationSystem system = SystemOf(freed, now, equations.score, equations.information,
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
  return MostProbable(refined, now, equations, prior, Inflation(equations, options));
}

std::optional<ProbableCorrection> MostProbable(RigRefinement refined, const CalibrationVector& now,
                                               const CalibrationEquations& equations,
                                               const CalibrationPrior& prior, double inflation) {
  const CalibrationVector freed = FreedBy(refined);
  const CalibrationSystem system =
      SystemOf(freed, now, equations.score, equations.information, inflation, prior);
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
  const double inflation = InflationOfPoses(equations, options);
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

}  // namespace rigmap
