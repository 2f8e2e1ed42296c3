// Points that no keypoint shows again, found where the motion shows them.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "correspondence/tracks.h"
#include "matching/match_frames.h"
#include "tests/support/rover_correspondences.h"
#include "tests/support/seeded_random.h"
#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

// A rover whose keypoints hardly any frame but one finds.
class CarriedPointsTest : public testing::Test {
 protected:
  static constexpr int kFrames = 6, kFoundAgain = 12;  // one of so many

  void SetUp() override {
    SeededRandom random;
    for (int i = 0; i < kFrames; ++i) {
      FrameFeatures& frame = rover_.frames[i];
      for (std::size_t f = 0; f < frame.features.size(); ++f) {
        if (rover_.point_of_feature[i][f] % kFoundAgain == 0) continue;
        for (auto& value : frame.descriptors[f]) {
          value = static_cast<std::uint8_t>(random.Uniform(0.0, 256.0));
        }
      }
    }
    odometry_ = OdometryOfKeyframes(rover_, DriftingPoses(rover_, 0.004, 0.002, random));
  }

  Correspondences Match(const MatchingOptions& options = {}) {
    return MatchFrames(
        odometry_, [this](int frame) { return rover_.frames[frame]; }, rover_.rig, options,
        [this](int frame, const std::vector<Eigen::Vector2d>& pixels) {
          asked_.insert(frame);
          return SampleFeatures(rover_, frame, pixels);
        });
  }
  Correspondences MatchWithoutImages() {
    return MatchFrames(
        odometry_, [this](int frame) { return rover_.frames[frame]; }, rover_.rig, {},
        [](int, const std::vector<Eigen::Vector2d>&) {
          return std::vector<std::optional<SampledFeature>>();
        });
  }

  static std::size_t Count(const Correspondences& found) {
    std::size_t count = 0;
    for (const FramePair& pair : found.pairs) {
      if (pair.b == pair.a + 1) count += pair.matches.size();
    }
    return count;
  }
  std::size_t Extracted(int frame) const { return rover_.frames[frame].features.size(); }

  SyntheticRover rover_ = MakeSyntheticRover(
      {.frames = kFrames, .points_per_m2 = 12.0, .pixel_sigma = 0.2, .textured_patches = true});
  Odometry odometry_;
  std::set<int> asked_;
};

TEST_F(CarriedPointsTest, AreSeveralTimesAsMany) {
  const std::size_t before = Count(MatchWithoutImages());
  ASSERT_GT(before, 50u);
  EXPECT_GT(Count(Match()), 3 * before);
}

TEST_F(CarriedPointsTest, BecomeFeaturesBehindThoseExtracted) {
  const Correspondences found = Match();
  ASSERT_EQ(found.features.size(), rover_.frames.size());
  EXPECT_EQ(found.features[0].size(), Extracted(0));
  for (int i = 1; i < kFrames; ++i) {
    EXPECT_GT(found.features[i].size(), Extracted(i)) << i;
    for (std::size_t f = 0; f < Extracted(i); ++f) {
      ASSERT_LT((found.features[i][f].left - rover_.frames[i].features[f].left).norm(), 4.0);
    }
  }
}

// All that a track shows is the ground of the extracted keypoint that it began with.
TEST_F(CarriedPointsTest, ShowTheGroundThatTheyWereCarriedFrom) {
  const Correspondences found = Match();
  int carried = 0, in_both_eyes = 0, right = 0, long_tracks = 0;
  for (const Track& track : BuildTracks(found, false)) {
    const FeatureRef& first = track.front();
    ASSERT_LT(first.feature, static_cast<int>(Extracted(first.frame)));
    const int point = rover_.point_of_feature[first.frame][first.feature];
    long_tracks += track.size() >= 3 ? 1 : 0;
    for (const FeatureRef& ref : track) {
      if (ref.feature < static_cast<int>(Extracted(ref.frame))) continue;
      ++carried;
      const Feature& feature = found.features[ref.frame][ref.feature];
      const Eigen::Vector3d x = rover_.world_from_left[ref.frame].Inverse() * rover_.points[point];
      const double off_px = (feature.left - *Project(rover_.rig.left.camera, x)).norm();
      right += off_px < 1.0 ? 1 : 0;  // keypoints are off by 0.2 px on each axis, and grow
      in_both_eyes += feature.right ? 1 : 0;
    }
  }
  EXPECT_GT(carried, 200);
  EXPECT_GT(right, 0.99 * carried);
  EXPECT_GT(in_both_eyes, 0.8 * carried);
  EXPECT_GT(long_tracks, 50);
}

TEST_F(CarriedPointsTest, MatchesStayOneToOne) {
  for (const FramePair& pair : Match().pairs) {
    std::set<unsigned> of_a, of_b;
    for (const auto& [a, b] : pair.matches) {
      EXPECT_TRUE(of_a.insert(a).second);
      EXPECT_TRUE(of_b.insert(b).second);
    }
  }
}

TEST_F(CarriedPointsTest, AreNotLookedForWhereTheyAreNotWanted) {
  const std::size_t before = Count(MatchWithoutImages());
  EXPECT_EQ(Count(Match({.carry_below_share = 0.0})), before);
  EXPECT_TRUE(asked_.empty());
}

TEST_F(CarriedPointsTest, AreNotLookedForWhereKeypointsAreFoundAgain) {
  rover_ = MakeSyntheticRover(
      {.frames = kFrames, .points_per_m2 = 12.0, .pixel_sigma = 0.2, .textured_patches = true});
  const Correspondences found = Match();
  EXPECT_TRUE(asked_.empty());
  for (int i = 0; i < kFrames; ++i) EXPECT_EQ(found.features[i].size(), Extracted(i));
}

TEST_F(CarriedPointsTest, AreNotTakenWherePatchesDoNotAgree) {
  const Correspondences found = MatchFrames(
      odometry_, [this](int frame) { return rover_.frames[frame]; }, rover_.rig, {},
      [this](int frame, const std::vector<Eigen::Vector2d>& pixels) {
        auto sampled = SampleFeatures(rover_, frame, pixels);
        for (std::size_t i = 1; i < sampled.size(); ++i) {  // the texture of some other point
          if (sampled[i] && sampled[i - 1]) sampled[i]->patch = sampled[i - 1]->patch;
        }
        return sampled;
      });
  std::size_t carried = 0;
  for (int i = 0; i < kFrames; ++i) carried += found.features[i].size() - Extracted(i);
  EXPECT_LT(carried, 20u);
}

}  // namespace
}  // namespace rigmap
