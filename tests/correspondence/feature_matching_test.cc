#include "correspondence/feature_matching.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

using testing::IsEmpty;
using Pixels = std::vector<std::optional<Eigen::Vector2d>>;

Descriptor RandomDescriptor(SeededRandom& random) {
  Descriptor descriptor;
  for (auto& value : descriptor) value = static_cast<std::uint8_t>(random.Uniform(20.0, 90.0));
  return descriptor;
}

Descriptor Disturbed(const Descriptor& descriptor, double sigma, SeededRandom& random) {
  Descriptor result;
  for (int i = 0; i < kDescriptorSize; ++i) {
    result[i] =
        static_cast<std::uint8_t>(std::clamp(descriptor[i] + random.Normal(sigma), 0.0, 255.0));
  }
  return result;
}

void Add(FrameFeatures& frame, const Descriptor& descriptor, const Eigen::Vector2d& left) {
  frame.features.push_back({.left = left});
  frame.descriptors.push_back(descriptor);
}

// Feature i of a is feature (count - 1 - i) of b, 10 px to the right; each frame has as many of its
// own besides.
struct Pair {
  FrameFeatures a, b;
  int shared = 0;
};

Pair MakePair(int shared, double sigma, SeededRandom& random) {
  Pair pair{.shared = shared};
  for (int i = 0; i < shared; ++i) {
    const Eigen::Vector2d at(random.Uniform(0.0, 1000.0), random.Uniform(0.0, 700.0));
    Add(pair.a, RandomDescriptor(random), at);
  }
  for (int i = shared - 1; i >= 0; --i) {
    Add(pair.b, Disturbed(pair.a.descriptors[i], sigma, random),
        pair.a.features[i].left + Eigen::Vector2d(10.0, 0.0));
  }
  for (FrameFeatures* frame : {&pair.a, &pair.b}) {
    for (int i = 0; i < shared; ++i) {
      Add(*frame, RandomDescriptor(random),
          {random.Uniform(0.0, 1000.0), random.Uniform(0.0, 700.0)});
    }
  }
  return pair;
}

std::set<std::pair<int, int>> AsSet(const std::vector<FeatureMatch>& matches, bool swapped) {
  std::set<std::pair<int, int>> set;
  for (const auto& m : matches) set.emplace(swapped ? m.b : m.a, swapped ? m.a : m.b);
  return set;
}

TEST(MatchFeatures, FindsAllThatLookAlikeAndNothingElse) {
  SeededRandom random;
  const Pair pair = MakePair(200, 4.0, random);
  const auto matches = MatchFeatures(pair.a, pair.b, {});
  EXPECT_EQ(matches.size(), 200u);
  for (const auto& match : matches) EXPECT_EQ(match.b, pair.shared - 1 - match.a);
}

TEST(MatchFeatures, IsSymmetricAndOneToOne) {
  SeededRandom random;
  // So disturbed that many are ambiguous; some have twins.
  Pair pair = MakePair(150, 16.0, random);
  for (int i = 0; i < 20; ++i) Add(pair.b, pair.b.descriptors[i], {1.0, 1.0});
  const auto forward = MatchFeatures(pair.a, pair.b, {});
  EXPECT_GT(forward.size(), 50u);
  EXPECT_LT(forward.size(), 150u);
  EXPECT_EQ(AsSet(forward, false), AsSet(MatchFeatures(pair.b, pair.a, {}), true));
  std::set<int> of_a, of_b;
  for (const auto& match : forward) {
    EXPECT_TRUE(of_a.insert(match.a).second);
    EXPECT_TRUE(of_b.insert(match.b).second);
  }
}

// Descriptors that differ in one entry, by their distance from zero.
Descriptor AtDistance(int distance) {
  Descriptor descriptor{};
  descriptor[0] = static_cast<std::uint8_t>(distance);
  return descriptor;
}

TEST(MatchFeatures, TakesOnlyMutualBest) {
  FrameFeatures a, b;
  Add(a, AtDistance(0), {0.0, 0.0});
  Add(a, AtDistance(9), {0.0, 0.0});
  Add(b, AtDistance(10), {0.0, 0.0});
  const auto matches = MatchFeatures(a, b, {});
  ASSERT_EQ(matches.size(), 1u);  // b's best is a's second, whose ratio is 1 to 10
  EXPECT_EQ(matches[0].a, 1);
}

TEST(MatchFeatures, RatioAppliesOnBothSides) {
  FrameFeatures one, two;
  Add(one, AtDistance(0), {0.0, 0.0});
  Add(two, AtDistance(80), {0.0, 0.0});
  Add(two, AtDistance(100), {0.0, 0.0});
  EXPECT_EQ(MatchFeatures(one, two, {.max_ratio = 0.81}).size(), 1u);
  EXPECT_THAT(MatchFeatures(one, two, {.max_ratio = 0.79}), IsEmpty());
  EXPECT_EQ(MatchFeatures(two, one, {.max_ratio = 0.81}).size(), 1u);
  EXPECT_THAT(MatchFeatures(two, one, {.max_ratio = 0.79}), IsEmpty());
}

TEST(MatchFeatures, RefusesPerfectTwins) {
  FrameFeatures one, twins;
  Add(one, AtDistance(7), {0.0, 0.0});
  Add(twins, AtDistance(7), {0.0, 0.0});
  Add(twins, AtDistance(7), {50.0, 0.0});
  EXPECT_THAT(MatchFeatures(one, twins, {}), IsEmpty());
  EXPECT_THAT(MatchFeatures(twins, one, {}), IsEmpty());
}

TEST(MatchFeatures, RefusesWhatIsTooUnlike) {
  FrameFeatures a, b;
  Add(a, AtDistance(0), {0.0, 0.0});
  Add(b, AtDistance(100), {0.0, 0.0});
  EXPECT_EQ(MatchFeatures(a, b, {.max_distance = 100.0}).size(), 1u);
  EXPECT_THAT(MatchFeatures(a, b, {.max_distance = 99.0}), IsEmpty());
}

TEST(MatchFeatures, EmptyFramesMatchNothing) {
  SeededRandom random;
  const Pair pair = MakePair(5, 1.0, random);
  EXPECT_THAT(MatchFeatures({}, pair.b, {}), IsEmpty());
  EXPECT_THAT(MatchFeatures(pair.a, {}, {}), IsEmpty());
  EXPECT_THAT(MatchFeatures({}, {}, {}), IsEmpty());
  EXPECT_THAT(MatchFeatures({}, pair.b, Pixels{}, 10.0, {}), IsEmpty());
  EXPECT_THAT(MatchFeatures(pair.a, {}, Pixels(10), 10.0, {}), IsEmpty());
}

TEST(MatchFeaturesNear, HonoursTheRadius) {
  SeededRandom random;
  const Pair pair = MakePair(100, 2.0, random);
  Pixels predicted(pair.a.features.size());
  for (int i = 0; i < pair.shared; ++i) {
    // At a distance of i / 10 px from its place in b, in any direction.
    const double direction = random.Uniform(-3.0, 3.0);
    predicted[i] = pair.b.features[pair.shared - 1 - i].left +
                   0.1 * i * Eigen::Vector2d(std::cos(direction), std::sin(direction));
  }
  constexpr double kRadius_px = 5.05;
  const auto matches = MatchFeatures(pair.a, pair.b, predicted, kRadius_px, {});
  int true_matches = 0;
  for (const auto& match : matches) {
    true_matches += match.b == pair.shared - 1 - match.a ? 1 : 0;
    EXPECT_LE((pair.b.features[match.b].left - *predicted[match.a]).norm(), kRadius_px);
  }
  EXPECT_EQ(true_matches, 51);  // 0 to 5.0 px off
}

TEST(MatchFeaturesNear, TellsTwinsApartAndLeavesOutTheUnpredicted) {
  FrameFeatures a, b;
  for (int i = 0; i < 3; ++i) {
    Add(a, AtDistance(7), {100.0 * i, -30.0});
    Add(b, AtDistance(7), {100.0 * i + 2.0, -31.0});
  }
  const Pixels predicted{a.features[0].left, std::nullopt, a.features[2].left};
  const auto matches = MatchFeatures(a, b, predicted, 20.0, {});
  EXPECT_EQ(AsSet(matches, false), (std::set<std::pair<int, int>>{{0, 0}, {2, 2}}));
}

TEST(MatchFeaturesNear, SurvivesPredictionsFarOutside) {
  FrameFeatures a, b;
  Add(a, AtDistance(7), {0.0, 0.0});
  Add(b, AtDistance(7), {0.0, 0.0});
  for (const double far : {1e10, -1e10, 1e300, -1e300}) {
    EXPECT_THAT(MatchFeatures(a, b, Pixels{Eigen::Vector2d(far, -far)}, 5.0, {}), IsEmpty());
  }
}

TEST(MatchFeaturesNear, WithAWideRadiusIsMatchingEverywhere) {
  SeededRandom random;
  const Pair pair = MakePair(80, 14.0, random);
  const Pixels centre(pair.a.features.size(), Eigen::Vector2d(500.0, 350.0));
  EXPECT_EQ(AsSet(MatchFeatures(pair.a, pair.b, centre, 2000.0, {}), false),
            AsSet(MatchFeatures(pair.a, pair.b, {}), false));
}

}  // namespace
}  // namespace rigmap
