#include "geometry/plane_fit.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

const Eigen::Vector3d kPlane(0.3, -0.2, 5.0);

double OnPlane(double x, double y) { return kPlane.dot(Eigen::Vector3d(x, y, 1.0)); }

TEST(PlaneFit, GivesBackThePlaneItsPointsLieOn) {
  SeededRandom random;
  PlaneFit fit;
  for (int i = 0; i < 20; ++i) {
    const double x = random.Uniform(-4.0, 4.0), y = random.Uniform(-4.0, 4.0);
    fit.Add(x, y, OnPlane(x, y), random.Uniform(0.1, 2.0));
  }
  EXPECT_LT((fit.Solve() - kPlane).norm(), 1e-12);
}

TEST(PlaneFit, LeavesResidualsOrthogonalToTheRegressors) {
  SeededRandom random;
  PlaneFit fit;
  std::vector<Eigen::Vector4d> samples;  // x, y, value, weight
  for (int i = 0; i < 30; ++i) {
    samples.emplace_back(random.Uniform(-4.0, 4.0), random.Uniform(-4.0, 4.0),
                         random.Uniform(-1.0, 1.0), random.Uniform(0.1, 2.0));
    fit.Add(samples.back()[0], samples.back()[1], samples.back()[2], samples.back()[3]);
  }
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  for (const Eigen::Vector4d& s : samples) {
    const Eigen::Vector3d regressor(s[0], s[1], 1.0);
    gradient += s[3] * (s[2] - fit.Solve().dot(regressor)) * regressor;
  }
  EXPECT_LT(gradient.norm(), 1e-10);
}

TEST(PlaneFit, AWeightCountsAsThatManyPoints) {
  SeededRandom random;
  PlaneFit weighted, repeated;
  for (int i = 0; i < 10; ++i) {
    const double x = random.Uniform(-4.0, 4.0), y = random.Uniform(-4.0, 4.0),
                 value = random.Uniform(-1.0, 1.0);
    weighted.Add(x, y, value, 3.0);
    for (int k = 0; k < 3; ++k) repeated.Add(x, y, value);
  }
  EXPECT_LT((weighted.Solve() - repeated.Solve()).norm(), 1e-12);
}

TEST(PlaneFit, PriorHoldsWhatThePositionsDoNotTell) {
  PlaneFit held(Eigen::Vector3d(0.05, 0.05, 0.0)), loose;
  for (PlaneFit* fit : {&held, &loose}) {
    for (int i = 0; i < 3; ++i) fit->Add(0.0, 0.0, 2.0);
  }
  EXPECT_LT((held.Solve() - Eigen::Vector3d(0.0, 0.0, 2.0)).norm(), 1e-12);
  EXPECT_FALSE(loose.Solve().allFinite());
}

}  // namespace
}  // namespace rigmap
