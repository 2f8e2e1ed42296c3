#include "georeference/fix_judgement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace rigmap {
namespace {

constexpr double kSigma_m = 0.008;

// Fixes with noise beside two paths that are off by so much, alternately east and north.
std::vector<FixBesideTwoPaths> Beside(double first_off_m, double second_off_m, int count,
                                      unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, kSigma_m);
  std::vector<FixBesideTwoPaths> fixes;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector2d away = i % 2 == 0 ? Eigen::Vector2d::UnitX() : Eigen::Vector2d::UnitY();
    const Eigen::Vector2d fix(noise(random), noise(random));
    fixes.push_back({first_off_m * away - fix, second_off_m * away - fix, kSigma_m, i / 5});
  }
  return fixes;
}

TEST(FixJudgement, ANearerPathGains) {
  const auto judgement = JudgeByFixes(Beside(0.02, 0.0, 40, 1));
  ASSERT_TRUE(judgement);
  EXPECT_NEAR(judgement->first_m, std::hypot(0.02, kSigma_m * std::sqrt(2.0)), 0.004);
  EXPECT_NEAR(judgement->second_m, kSigma_m * std::sqrt(2.0), 0.002);
  EXPECT_GT(judgement->gain_sigmas, 4.0);
  EXPECT_LT(JudgeByFixes(Beside(0.0, 0.02, 40, 1))->gain_sigmas, -1.5);
}

// Paths a millimetre apart, whichever lies nearer: no more than one time in twenty beyond two
// sigmas, and as often on one side as on the other.
TEST(FixJudgement, ChanceGainsNothing) {
  int gains = 0, beyond_two = 0;
  constexpr int kTrials = 400;
  for (int i = 0; i < kTrials; ++i) {
    const auto judgement = JudgeByFixes(Beside(0.0005, -0.0005, 10, 100 + i));
    gains += judgement->gain_sigmas > 0.0;
    beyond_two += std::abs(judgement->gain_sigmas) > 2.0;
  }
  EXPECT_NEAR(gains, kTrials / 2, 3.0 * std::sqrt(kTrials) / 2.0);
  EXPECT_LT(beyond_two, kTrials / 20);
}

// A receiver that is off by the same for ten seconds has said it once.
TEST(FixJudgement, NoiseThatATurnHasInCommonGainsNothingEither) {
  constexpr int kTrials = 400, kTurns = 8, kOfATurn = 10;
  int beyond_two = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::mt19937 random(500 + trial);
    std::normal_distribution<double> noise(0.0, kSigma_m);
    std::vector<FixBesideTwoPaths> fixes;
    for (int turn = 0; turn < kTurns; ++turn) {
      const Eigen::Vector2d fix(noise(random), noise(random)), half_shift(0.0005, 0.0);
      for (int i = 0; i < kOfATurn; ++i) {
        fixes.push_back({half_shift - fix, -half_shift - fix, kSigma_m, turn});
      }
    }
    beyond_two += std::abs(JudgeByFixes(fixes)->gain_sigmas) > 2.0;
  }
  EXPECT_LT(beyond_two, kTrials / 20);
}

TEST(FixJudgement, EqualPathsGainNothing) {
  EXPECT_EQ(JudgeByFixes(Beside(0.01, 0.01, 9, 3))->gain_sigmas, 0.0);
}

TEST(FixJudgement, OutliersAndTooFewJudgeNobody) {
  auto fixes = Beside(0.001, 0.0, 20, 4);
  const auto before = JudgeByFixes(fixes);
  fixes.push_back({{5.0, 0.0}, {4.0, 0.0}, kSigma_m});
  EXPECT_NEAR(JudgeByFixes(fixes)->gain_sigmas, before->gain_sigmas, 1e-12);
  EXPECT_FALSE(JudgeByFixes(Beside(0.001, 0.0, 3, 4)));
}

}  // namespace
}  // namespace rigmap
