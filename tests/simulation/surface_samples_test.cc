#include "simulation/internal/surface_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "tests/simulation/small_world.h"
#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

constexpr double kReach_m = 3.6;

std::vector<SurfaceSample> AllSamples() {
  const auto outline = SmallOutline();
  const SurfaceSampler sampler(SmallWorld(), outline, kReach_m);
  std::vector<SurfaceSample> all;
  for (int i = 0; i < sampler.batch_count(); ++i) {
    const auto batch = sampler.Batch(i);
    all.insert(all.end(), batch.begin(), batch.end());
  }
  return all;
}

double DistanceFromOutline(const Eigen::Vector3d& x) {
  return std::hypot(x.x() - std::clamp(x.x(), 0.0, 2.0), x.y());
}

std::size_t Count(const std::vector<SurfaceSample>& samples, SurfaceKind kind) {
  return static_cast<std::size_t>(std::count_if(
      samples.begin(), samples.end(), [&](const auto& sample) { return sample.kind == kind; }));
}

TEST(SurfaceSamples, LieOnTheWorld) {
  std::map<SurfaceKind, int> other_kind, checked;
  for (const SurfaceSample& sample : AllSamples()) {
    constexpr double kAway_m = 0.002;  // a neighbouring facet may be nearer to a place farther away
    const auto hit = SmallWorld().Cast(sample.position + kAway_m * sample.normal, -sample.normal);
    ASSERT_TRUE(hit);
    ++checked[sample.kind];
    // Debris lies on sand and boulders; what is next to a point within 2 mm may be the other.
    if (hit->kind != sample.kind) {
      ++other_kind[sample.kind];
      continue;
    }
    EXPECT_NEAR(hit->distance_m, kAway_m, kSmallNoise_m);
  }
  for (const auto kind : {SurfaceKind::kSand, SurfaceKind::kRock, SurfaceKind::kDebris}) {
    EXPECT_GT(checked[kind], 100);
    EXPECT_LT(other_kind[kind], 0.1 * checked[kind]);
  }
}

TEST(SurfaceSamples, NormalsAreOfUnitLengthAndPointOutwards) {
  for (const SurfaceSample& sample : AllSamples()) {
    EXPECT_NEAR(sample.normal.norm(), 1.0, 1e-9);
    if (sample.kind == SurfaceKind::kSand) {
      EXPECT_GT(sample.normal.z(), 0.0);
    }
  }
  const auto outline = SmallOutline();
  const SurfaceSampler sampler(SmallWorld(), outline, kReach_m);
  const auto& boulders = SmallWorld().boulders();
  const int first =
      sampler.batch_count() - static_cast<int>(boulders.size() + SmallWorld().debris().size());
  for (std::size_t i = 0; i < boulders.size(); ++i) {
    int outwards = 0;
    const auto samples = sampler.Batch(first + static_cast<int>(i));
    for (const SurfaceSample& sample : samples) {
      EXPECT_EQ(sample.kind, SurfaceKind::kRock);
      outwards += sample.normal.dot(sample.position - boulders[i].centre) > 0.0;
    }
    EXPECT_GE(outwards, 0.98 * static_cast<double>(samples.size()));
  }
}

TEST(SurfaceSamples, ReachAsFarAsTheyShould) {
  double farthest_m = 0.0;
  for (const SurfaceSample& sample : AllSamples()) {
    farthest_m = std::max(farthest_m, DistanceFromOutline(sample.position));
  }
  EXPECT_LE(farthest_m, kReach_m + 1e-9);
  EXPECT_GT(farthest_m, kReach_m - kSmallCell_m);
}

TEST(SurfaceSamples, SandIsEveryNodeThatNoBoulderCovers) {
  std::map<std::pair<int, int>, double> height_m;
  for (const SurfaceSample& sample : AllSamples()) {
    if (sample.kind != SurfaceKind::kSand) continue;
    const std::pair node{static_cast<int>(std::lround(sample.position.x() / kSmallCell_m)),
                         static_cast<int>(std::lround(sample.position.y() / kSmallCell_m))};
    EXPECT_TRUE(height_m.emplace(node, sample.position.z()).second) << "a node came twice";
  }
  int covered = 0, open = 0;
  for (int i = -80; i <= 120; ++i) {
    for (int j = -80; j <= 80; ++j) {
      const Eigen::Vector3d position(i * kSmallCell_m, j * kSmallCell_m, 3.0);
      if (DistanceFromOutline(position) > kReach_m - 1e-3) continue;
      const auto from_above = SmallWorld().Cast(position, -Eigen::Vector3d::UnitZ());
      ASSERT_TRUE(from_above);
      const auto node = height_m.find({i, j});
      if (from_above->kind == SurfaceKind::kSand) {
        ASSERT_NE(node, height_m.end()) << position.transpose();
        EXPECT_NEAR(node->second, from_above->position.z(), kSmallNoise_m);
        ++open;
      } else if (from_above->kind == SurfaceKind::kRock && node == height_m.end()) {
        ++covered;
      }
    }
  }
  EXPECT_GT(open, 10000);
  EXPECT_GT(covered, 50);
}

TEST(SurfaceSamples, BouldersAreSampledDensely) {
  // A random place on a boulder that is seen from above has a sample within a centimetre.
  const auto samples = AllSamples();
  SeededRandom random;
  int checked = 0;
  for (const Boulder& boulder : SmallWorld().boulders()) {
    for (int k = 0; k < 20; ++k) {
      const Eigen::Vector3d above =
          boulder.centre + Eigen::Vector3d(random.Uniform(-0.3, 0.3), random.Uniform(-0.3, 0.3), 3);
      const auto hit = SmallWorld().Cast(above, -Eigen::Vector3d::UnitZ());
      if (!hit || hit->kind != SurfaceKind::kRock) continue;
      if (DistanceFromOutline(hit->position) > kReach_m - 0.02) continue;
      if (hit->position.z() < boulder.centre.z() + 0.05) continue;
      const auto nearest = std::min_element(samples.begin(), samples.end(),
                                            [&](const SurfaceSample& a, const SurfaceSample& b) {
                                              return (a.position - hit->position).squaredNorm() <
                                                     (b.position - hit->position).squaredNorm();
                                            });
      EXPECT_LT((nearest->position - hit->position).norm(), 0.01);
      ++checked;
    }
  }
  EXPECT_GT(checked, 10);
  EXPECT_GT(Count(samples, SurfaceKind::kRock), 1000u);
}

}  // namespace
}  // namespace rigmap
