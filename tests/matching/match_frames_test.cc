#include "matching/match_frames.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "correspondence/tracks.h"
#include "tests/support/rover_correspondences.h"
#include "tests/support/seeded_random.h"
#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

SyntheticRoverOptions Textured() {
  return {.frames = 8, .points_per_m2 = 12.0, .pixel_sigma = 0.2, .textured_patches = true};
}

Odometry DriftingOdometry(const SyntheticRover& rover, SeededRandom& random) {
  return OdometryOfKeyframes(rover, DriftingPoses(rover, 0.004, 0.002, random));
}

Correspondences Match(const SyntheticRover& rover, const Odometry& odometry,
                      const MatchingOptions& options = {}) {
  const auto features = [&](int frame) { return rover.frames[frame]; };
  return MatchFrames(odometry, features, rover.rig, options);
}

struct Score {
  int found = 0, right = 0, possible = 0;
};

Score Compare(const SyntheticRover& rover, const FramePair& pair) {
  Score score{.found = static_cast<int>(pair.matches.size())};
  for (const auto& [a, b] : pair.matches) {
    score.right += rover.point_of_feature[pair.a][a] == rover.point_of_feature[pair.b][b] ? 1 : 0;
  }
  for (const auto& [a, b] : TrueMatches(rover, pair.a, pair.b)) {
    score.possible += rover.frames[pair.a].features[a].right.has_value() ? 1 : 0;
  }
  return score;
}

Score Compare(const SyntheticRover& rover, const Correspondences& found) {
  Score sum;
  for (const FramePair& pair : found.pairs) {
    const Score score = Compare(rover, pair);
    sum.found += score.found;
    sum.right += score.right;
    sum.possible += score.possible;
  }
  return sum;
}

const FramePair* Find(const Correspondences& found, int a, int b) {
  for (const FramePair& pair : found.pairs) {
    if (pair.a == a && pair.b == b) return &pair;
  }
  return nullptr;
}

// Every second descriptor is exchanged with that of some other feature.
void Confuse(FrameFeatures& frame, SeededRandom& random) {
  for (std::size_t i = 0; i < frame.descriptors.size(); i += 2) {
    const auto other = static_cast<std::size_t>(
        random.Uniform(0.0, static_cast<double>(frame.descriptors.size())));
    std::swap(frame.descriptors[i], frame.descriptors[other]);
  }
}

TEST(MatchFrames, FindsTheTrueMatches) {
  SeededRandom random;
  const SyntheticRover rover = MakeSyntheticRover(Textured());
  const Correspondences found = Match(rover, DriftingOdometry(rover, random));
  ASSERT_EQ(found.features.size(), rover.frames.size());
  for (std::size_t i = 0; i < rover.frames.size(); ++i) {
    EXPECT_EQ(found.features[i].size(), rover.frames[i].features.size());
  }
  for (int b = 1; b < 8; ++b) EXPECT_TRUE(Find(found, b - 1, b)) << b;
  const Score score = Compare(rover, found);
  EXPECT_GT(score.right, 0.99 * score.found);
  EXPECT_GT(score.right, 0.8 * score.possible);
}

TEST(MatchFrames, MatchesAreOneToOne) {
  SeededRandom random;
  const SyntheticRover rover = MakeSyntheticRover(Textured());
  const Correspondences found = Match(rover, DriftingOdometry(rover, random));
  ASSERT_FALSE(found.pairs.empty());
  for (const FramePair& pair : found.pairs) {
    EXPECT_LT(pair.a, pair.b);
    EXPECT_FALSE(pair.matches.empty());
    std::set<unsigned> of_a, of_b;
    for (const auto& [a, b] : pair.matches) {
      EXPECT_TRUE(of_a.insert(a).second);
      EXPECT_TRUE(of_b.insert(b).second);
    }
  }
}

TEST(MatchFrames, StaysPreciseAmongWrongDescriptors) {
  SeededRandom random;
  SyntheticRover rover = MakeSyntheticRover(Textured());
  for (FrameFeatures& frame : rover.frames) Confuse(frame, random);
  const Correspondences found = Match(rover, DriftingOdometry(rover, random));
  const Score score = Compare(rover, found);
  EXPECT_GT(score.found, 300);
  EXPECT_GT(score.right, 0.99 * score.found);
}

TEST(MatchFrames, ViewsOfAPointMeanTheSameSpot) {
  SeededRandom random;
  const SyntheticRover rover = MakeSyntheticRover(Textured());
  const Correspondences found = Match(rover, DriftingOdometry(rover, random));
  std::vector<double> before_px, after_px;
  for (const Track& track : BuildTracks(found, false)) {
    const auto off = [&](const FeatureRef& ref, const Feature& feature) -> Eigen::Vector2d {
      const Rigid3 left_from_world = rover.world_from_left[ref.frame].Inverse();
      const Eigen::Vector3d x =
          left_from_world * rover.points[rover.point_of_feature[ref.frame][ref.feature]];
      // In pixels as from 4 m.
      return x.z() / 4.0 * (feature.left - *Project(rover.rig.left.camera, x));
    };
    const FeatureRef &first = track.front(), &last = track.back();
    const auto& raw = rover.frames;
    before_px.push_back((off(first, raw[first.frame].features[first.feature]) -
                         off(last, raw[last.frame].features[last.feature]))
                            .norm());
    after_px.push_back((off(first, found.features[first.frame][first.feature]) -
                        off(last, found.features[last.frame][last.feature]))
                           .norm());
  }
  std::sort(before_px.begin(), before_px.end());
  std::sort(after_px.begin(), after_px.end());
  ASSERT_GT(after_px.size(), 150u);
  EXPECT_GT(before_px[before_px.size() / 2], 0.2);
  EXPECT_LT(after_px[after_px.size() / 2], 0.05);
  EXPECT_LT(after_px[after_px.size() * 9 / 10], 0.15);
}

TEST(MatchFrames, MatchesALoopClosure) {
  SeededRandom random;
  std::vector<Rigid3> path;
  for (int i = 0; i < 22; ++i) {
    const double heading = 2.0 * std::numbers::pi * i / 20;
    path.push_back(RoverPose(2.0 * std::sin(heading), 2.0 * (1.0 - std::cos(heading)), heading));
  }
  const SyntheticRover rover = MakeSyntheticRover(Textured(), path);
  const Correspondences found = Match(rover, DriftingOdometry(rover, random));
  const FramePair* loop_closure = Find(found, 0, 20);
  ASSERT_TRUE(loop_closure);
  const Score score = Compare(rover, *loop_closure);
  EXPECT_GT(score.right, 0.99 * score.found);
  EXPECT_GT(score.right, 0.5 * score.possible);
}

TEST(MatchFrames, OtherFramesHangOnTheKeyframesAroundThem) {
  SeededRandom random;
  const SyntheticRover rover = MakeSyntheticRover(Textured());
  Odometry odometry = DriftingOdometry(rover, random);
  for (int i : {1, 3, 4, 6}) odometry[i].keyframe = false;
  const Correspondences found = Match(rover, odometry);
  for (const auto& [a, b] : {std::pair(0, 1), {1, 2}, {2, 3}, {3, 5}, {2, 4}, {4, 5}, {5, 6}}) {
    const FramePair* pair = Find(found, a, b);
    ASSERT_TRUE(pair) << a << " " << b;
    const Score score = Compare(rover, *pair);
    EXPECT_GT(score.right, 0.99 * score.found);
    EXPECT_GT(score.right, 0.7 * score.possible) << a << " " << b;
  }
  EXPECT_FALSE(Find(found, 3, 4));
}

TEST(MatchFrames, PatchesDecide) {
  SeededRandom random;
  SyntheticRover rover = MakeSyntheticRover(Textured());
  // Frame 3 shows other textures: geometry and descriptors alone do not make a match.
  auto& patches = rover.frames[3].patches;
  std::rotate(patches.begin(), patches.begin() + 5, patches.end());
  const Correspondences found = Match(rover, DriftingOdometry(rover, random));
  EXPECT_FALSE(Find(found, 2, 3));
  EXPECT_FALSE(Find(found, 3, 4));
  EXPECT_TRUE(Find(found, 2, 4));
}

TEST(MatchFrames, EqualInputGivesEqualOutput) {
  SeededRandom random;
  SyntheticRoverOptions options = Textured();
  options.frames = 4;
  const SyntheticRover rover = MakeSyntheticRover(options);
  const Odometry odometry = DriftingOdometry(rover, random);
  const Correspondences first = Match(rover, odometry), second = Match(rover, odometry);
  ASSERT_EQ(first.pairs.size(), second.pairs.size());
  for (std::size_t i = 0; i < first.pairs.size(); ++i) {
    EXPECT_EQ(first.pairs[i].matches, second.pairs[i].matches);
  }
  for (int frame = 0; frame < 4; ++frame) {
    for (std::size_t i = 0; i < first.features[frame].size(); ++i) {
      EXPECT_EQ(first.features[frame][i].left, second.features[frame][i].left);
    }
  }
}

TEST(MatchFrames, EmptyFramesMatchNothing) {
  SeededRandom random;
  SyntheticRover rover = MakeSyntheticRover(Textured());
  rover.frames[2] = FrameFeatures{.stamp_ns = rover.frames[2].stamp_ns};
  const Correspondences found = Match(rover, DriftingOdometry(rover, random));
  EXPECT_TRUE(found.features[2].empty());
  for (const FramePair& pair : found.pairs) EXPECT_TRUE(pair.a != 2 && pair.b != 2);
  EXPECT_TRUE(Find(found, 1, 3));
  EXPECT_TRUE(Match(rover, {}).pairs.empty());
}

}  // namespace
}  // namespace rigmap
