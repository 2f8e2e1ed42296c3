#include "georeference/rigid2.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

Rigid2 RandomMotion(SeededRandom& random) {
  return {random.Uniform(-3.0, 3.0), random.Vector(100.0).head<2>()};
}

// Fixes as the motion moves points of a drive, off by a normal sigma (m).
std::vector<PlanePair> PairsOf(const Rigid2& motion, int count, double sigma_m,
                               SeededRandom& random) {
  std::vector<PlanePair> pairs;
  for (int i = 0; i < count; ++i) {
    PlanePair pair{.from = random.Vector(20.0).head<2>(), .sigma = {0.01, 0.01}};
    pair.to = motion * pair.from + random.Noise(sigma_m).head<2>();
    pairs.push_back(pair);
  }
  return pairs;
}

TEST(Rigid2, InverseTakesBack) {
  SeededRandom random;
  for (int i = 0; i < 20; ++i) {
    const Rigid2 motion = RandomMotion(random);
    const Eigen::Vector2d x = random.Vector(10.0).head<2>();
    EXPECT_LT((motion.Inverse() * (motion * x) - x).norm(), 1e-10);
  }
}

TEST(FitRobustly, GivesBackTheMotion) {
  SeededRandom random;
  for (int i = 0; i < 20; ++i) {
    const Rigid2 motion = RandomMotion(random);
    const Rigid2 found = FitRobustly(PairsOf(motion, 10, 0.0, random));
    EXPECT_NEAR(found.angle_rad, motion.angle_rad, 1e-10);
    EXPECT_LT((found.translation - motion.translation).norm(), 1e-9);
  }
}

TEST(FitRobustly, AMinorityOfOutliersHardlyMatters) {
  SeededRandom random;
  const Rigid2 motion = RandomMotion(random);
  std::vector<PlanePair> pairs = PairsOf(motion, 60, 0.01, random);
  for (std::size_t i = 0; i < 15; ++i) pairs[4 * i].to += random.Vector(5.0).head<2>();
  const Rigid2 found = FitRobustly(pairs);
  const Eigen::Vector2d x(5.0, -5.0);
  EXPECT_LT((found * x - motion * x).norm(), 0.02);  // m
}

TEST(FitRobustly, PairsCountByTheirSigmas) {
  SeededRandom random;
  const Rigid2 motion = RandomMotion(random);
  std::vector<PlanePair> pairs = PairsOf(motion, 40, 0.0, random);
  for (std::size_t i = 0; i < pairs.size(); i += 2) {
    pairs[i].to += Eigen::Vector2d(0.05, 0.0);
    pairs[i].sigma = {1.0, 1.0};
  }
  const Rigid2 found = FitRobustly(pairs);
  for (std::size_t i = 1; i < pairs.size(); i += 2) {
    EXPECT_LT((found * pairs[i].from - pairs[i].to).norm(), 1e-3);  // m
  }
}

TEST(FitRobustly, OnOneSpotTheAngleIsZero) {
  std::vector<PlanePair> pairs(3);
  for (PlanePair& pair : pairs) pair = {{1.0, 2.0}, {4.0, 6.0}, {0.01, 0.01}, {0.0, 0.0}};
  const Rigid2 found = FitRobustly(pairs);
  EXPECT_EQ(found.angle_rad, 0.0);
  EXPECT_LT((found.translation - Eigen::Vector2d(3.0, 4.0)).norm(), 1e-12);
}

TEST(NormalisedDistance, IsInSigmasOfEachAxis) {
  const PlanePair pair{{1.0, 2.0}, {1.3, 2.8}, {0.1, 0.2}, {0.0, 0.0}};
  EXPECT_NEAR(NormalisedDistance({}, pair), 5.0, 1e-12);
}

}  // namespace
}  // namespace rigmap
