#include "adjustment/internal/score_clusters.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

constexpr int kPoses = 4;
constexpr int kUnknowns = 6 * kPoses;

Eigen::MatrixXd RandomMatrix(int rows, int columns, SeededRandom& random) {
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return random.Uniform(-1.0, 1.0); });
}

// Symmetric and well conditioned, as a normal matrix is.
Eigen::MatrixXd InverseOfNormalMatrix(SeededRandom& random) {
  const Eigen::MatrixXd root = RandomMatrix(kUnknowns, kUnknowns, random);
  return (root.transpose() * root + Eigen::MatrixXd::Identity(kUnknowns, kUnknowns)).inverse();
}

// Adds clusters that know two poses each, and returns the same as whole vectors.
std::vector<Eigen::VectorXd> AddRandomClusters(int count, SeededRandom& random,
                                               ScoreClusters& clusters) {
  std::vector<Eigen::VectorXd> dense;
  for (int i = 0; i < count; ++i) {
    Eigen::VectorXd& score = dense.emplace_back(Eigen::VectorXd::Zero(kUnknowns));
    std::vector<ScoreClusters::Score> poses;
    for (const int pose : {i % kPoses, (i + 1) % kPoses}) {
      poses.emplace_back(pose, RandomMatrix(6, 1, random));
      score.segment<6>(6 * pose) = poses.back().second;
    }
    clusters.Add(std::move(poses));
  }
  return dense;
}

// N^-1 G N^-1, written out.
TEST(ScoreClusters, CovarianceIsTheSandwichOfWholeMatrices) {
  SeededRandom random;
  ScoreClusters clusters;
  const auto dense = AddRandomClusters(10, random, clusters);
  Eigen::MatrixXd outer = Eigen::MatrixXd::Zero(kUnknowns, kUnknowns);
  for (const Eigen::VectorXd& score : dense) outer += score * score.transpose();
  const Eigen::MatrixXd inverse = InverseOfNormalMatrix(random);
  const Eigen::MatrixXd sandwich = inverse * outer * inverse;
  for (int pose = 0; pose < kPoses; ++pose) {
    const Matrix6d found = clusters.Covariance(inverse.middleCols<6>(6 * pose));
    EXPECT_LT((found - sandwich.block<6, 6>(6 * pose, 6 * pose)).norm(), 1e-10) << pose;
  }
}

// Two equal scores that go together count like one of twice the size: four times, not twice.
TEST(ScoreClusters, WhatGoesTogetherAddsBeforeItIsSquared) {
  SeededRandom random;
  const Vector6d score = RandomMatrix(6, 1, random);
  ScoreClusters once, apart, together;
  once.Add({{1, score}});
  for (int i = 0; i < 2; ++i) apart.Add({{1, score}});
  together.Add({{1, 2.0 * score}});
  const Eigen::MatrixXd columns = RandomMatrix(kUnknowns, 6, random);
  EXPECT_LT((apart.Covariance(columns) - 2.0 * once.Covariance(columns)).norm(), 1e-10);
  EXPECT_LT((together.Covariance(columns) - 4.0 * once.Covariance(columns)).norm(), 1e-10);
}

TEST(ScoreClusters, WithoutClustersThereIsNoUncertainty) {
  const ScoreClusters none;
  EXPECT_EQ(none.Covariance(Eigen::MatrixXd::Ones(kUnknowns, 6)).norm(), 0.0);
}

}  // namespace
}  // namespace rigmap
