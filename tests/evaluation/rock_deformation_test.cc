#include "evaluation/rock_deformation.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

using Matches = std::vector<RockMatch>;

// Points all over an ellipsoid's upper half, matched by true correspondence, moved by `deform`.
template <class Deform>
Matches MatchAll(SeededRandom& random, const Deform& deform) {
  Matches matches;
  for (int i = 0; i < 2000; ++i) {
    Eigen::Vector3d normal = random.Vector(1.0).normalized();
    normal.z() = std::abs(normal.z());
    const Eigen::Vector3d x = 0.3 * normal;
    matches.push_back({x, normal, deform(x)});
  }
  return matches;
}

TEST(FitDeformation, RecoversShiftAndStretch) {
  SeededRandom random;
  const Eigen::Vector3d centre(0.01, -0.02, 0.1), stretch(1.004, 0.99, 1.007);
  const Eigen::Vector3d shift_m(0.003, -0.002, 0.001);
  const Eigen::Matrix3d axes = Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const auto deform = [&](const Eigen::Vector3d& x) -> Eigen::Vector3d {
    const Eigen::Vector3d arm = axes * (x - centre);
    return centre + axes.transpose() * stretch.cwiseProduct(arm) + shift_m;
  };
  const auto found = FitDeformation(MatchAll(random, deform), centre, axes);
  EXPECT_LT((found.stretch - stretch).norm(), 1e-9);
  EXPECT_LT(found.sigma_stretch.maxCoeff(), 1e-9);
}

TEST(FitDeformation, RecoversAShiftAlone) {
  SeededRandom random;
  const Eigen::Vector3d shift_m(0.003, -0.004, 0.0);
  const auto found =
      FitDeformation(MatchAll(random, [&](const auto& x) { return Eigen::Vector3d(x + shift_m); }),
                     Eigen::Vector3d(0.0, 0.0, 0.1), Eigen::Matrix3d::Identity());
  EXPECT_NEAR(found.shift_m, 0.005, 1e-12);
  EXPECT_LT((found.stretch - Eigen::Vector3d::Ones()).norm(), 1e-9);
}

TEST(FitDeformation, BearsWildPoints) {
  SeededRandom random;
  Matches matches =
      MatchAll(random, [&](const auto& x) { return Eigen::Vector3d(x + random.Noise(0.001)); });
  for (std::size_t i = 0; i < matches.size(); i += 20) matches[i].x_mapped.z() += 0.055;
  const auto found =
      FitDeformation(matches, Eigen::Vector3d(0.0, 0.0, 0.1), Eigen::Matrix3d::Identity());
  EXPECT_LT(found.shift_m, 0.001);
  EXPECT_LT((found.stretch - Eigen::Vector3d::Ones()).cwiseAbs().maxCoeff(), 0.01);
}

// Sigmas stand for a twenty-fifth of the points: five times the scatter of independent ones.
TEST(FitDeformation, SaysHowWellAStretchIsDetermined) {
  SeededRandom random;
  double squared = 0.0, sigma = 0.0;
  constexpr int kTrials = 40;
  for (int trial = 0; trial < kTrials; ++trial) {
    const auto found = FitDeformation(
        MatchAll(random, [&](const auto& x) { return Eigen::Vector3d(x + random.Noise(0.003)); }),
        Eigen::Vector3d(0.0, 0.0, 0.1), Eigen::Matrix3d::Identity());
    squared += std::pow(found.stretch.x() - 1.0, 2) / kTrials;
    sigma += found.sigma_stretch.x() / kTrials;
  }
  EXPECT_NEAR(sigma / (5.0 * std::sqrt(squared)), 1.0, 0.35);
}

// A slab seen from above tells nothing but its height.
TEST(FitDeformation, LeavesUnmovedWhatIsUndetermined) {
  SeededRandom random;
  Matches matches;
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3d x(random.Uniform(-0.2, 0.2), random.Uniform(-0.2, 0.2), 0.3);
    matches.push_back({x, Eigen::Vector3d::UnitZ(), x + Eigen::Vector3d(0.0, 0.0, 0.004)});
  }
  const auto found =
      FitDeformation(matches, Eigen::Vector3d(0.0, 0.0, 0.3), Eigen::Matrix3d::Identity());
  EXPECT_NEAR(found.shift_m, 0.004, 1e-12);
  EXPECT_LT((found.stretch - Eigen::Vector3d::Ones()).norm(), 1e-9);
}

}  // namespace
}  // namespace rigmap
