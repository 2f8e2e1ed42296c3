#include "adjustment/internal/prior_scale.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace rigmap {
namespace {

CalibrationPrior UsualPrior() {
  CalibrationPrior prior;
  for (int i = 0; i < kCalibrationSize; ++i) prior.sigmas(i) = 0.01 * (i + 1);
  prior.information.setZero();
  prior.information.diagonal() = prior.sigmas.cwiseAbs2().cwiseInverse();
  prior.is_stated = false;
  return prior;
}

// A part that knows the first `count` parameters to a thousandth of the prior, each of them off by
// `off` of its sigmas.
CalibrationEquations Knowing(int count, double off, const CalibrationPrior& prior) {
  CalibrationEquations equations;
  for (int i = 0; i < count; ++i) {
    equations.information(i, i) = 1e6 / (prior.sigmas(i) * prior.sigmas(i));
    equations.score(i) = equations.information(i, i) * off * prior.sigmas(i);
  }
  return equations;
}

double ScaleOf(int count, double off, const CalibrationPrior& prior) {
  return PriorScale(CalibrationVector::Zero(), Knowing(count, off, prior), 1.0, prior);
}

TEST(PriorScale, FollowsFromWhatThePartKnows) {
  const CalibrationPrior prior = UsualPrior();
  constexpr double kOneStep = 0.02;
  for (const int count : {0, 3, 8, int{kCalibrationSize}}) {
    for (const double off : {0.0, 0.3, 1.0, 4.0}) {
      const double expected = std::min(1.0, std::sqrt((1.0 + count * off * off) / (1.0 + count)));
      EXPECT_NEAR(ScaleOf(count, off, prior) / expected, 1.0, kOneStep) << count << " " << off;
    }
  }
}

TEST(PriorScale, CountsTheCorrectionAndNotTheStep) {
  const CalibrationPrior prior = UsualPrior();
  CalibrationEquations settled = Knowing(kCalibrationSize, 0.0, prior);
  EXPECT_NEAR(PriorScale(0.5 * prior.sigmas, settled, 1.0, prior), std::sqrt(5.25 / 18.0), 0.02);
  // What is known to no better than the prior says little.
  settled.information *= 1e-6;
  EXPECT_GT(PriorScale(CalibrationVector::Zero(), settled, 1.0, prior), 0.3);
  EXPECT_NEAR(PriorScale(CalibrationVector::Zero(), settled, 1e4, prior), 1.0, 0.05);
}

TEST(PriorScale, NeverMakesSurerThanTheRigFileStates) {
  CalibrationPrior stated = UsualPrior();
  stated.is_stated = true;
  EXPECT_EQ(ScaleOf(kCalibrationSize, 0.0, stated), 1.0);
  EXPECT_NEAR(ScaleOf(kCalibrationSize, 4.0, stated), 3.9, 0.1);
}

TEST(PriorScale, IsOneWhereNothingCanBeSaid) {
  const CalibrationPrior prior = UsualPrior();
  CalibrationEquations broken = Knowing(3, 1.0, prior);
  broken.information(0, 0) = std::nan("");
  EXPECT_EQ(PriorScale(CalibrationVector::Zero(), broken, 1.0, prior), 1.0);
}

}  // namespace
}  // namespace rigmap
