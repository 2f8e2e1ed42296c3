#include "correspondence/tracks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/support/rover_correspondences.h"
#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

using testing::UnorderedElementsAre;

// Frames of `count` features each, all with a stereo match.
Correspondences Frames(int frames, int count) {
  Feature feature{.left = {1.0, 2.0}, .right = Eigen::Vector2d(0.5, 2.0)};
  Correspondences result;
  result.features.assign(frames, std::vector<Feature>(count, feature));
  return result;
}

TEST(BuildTracks, JoinsMatchesThatShareAFeature) {
  Correspondences given = Frames(4, 3);
  given.pairs = {{0, 1, {{0, 1}}}, {2, 3, {{0, 0}}}, {1, 2, {{1, 0}, {2, 2}}}};
  EXPECT_THAT(BuildTracks(given, false),
              UnorderedElementsAre(Track{{0, 0}, {1, 1}, {2, 0}, {3, 0}}, Track{{1, 2}, {2, 2}}));
}

TEST(BuildTracks, ClosedLoopsAreNoConflict) {
  Correspondences given = Frames(3, 1);
  given.pairs = {{0, 1, {{0, 0}}}, {1, 2, {{0, 0}}}, {0, 2, {{0, 0}}}};
  EXPECT_THAT(BuildTracks(given, true), UnorderedElementsAre(Track{{0, 0}, {1, 0}, {2, 0}}));
}

TEST(BuildTracks, TheLaterOfTwoConflictingMatchesIsDropped) {
  Correspondences given = Frames(3, 2);
  given.pairs = {{0, 1, {{0, 0}, {1, 1}}}, {1, 2, {{0, 0}}}, {0, 2, {{1, 0}}}};
  EXPECT_THAT(BuildTracks(given, false),
              UnorderedElementsAre(Track{{0, 0}, {1, 0}, {2, 0}}, Track{{0, 1}, {1, 1}}));
  std::swap(given.pairs[1], given.pairs[2]);
  EXPECT_THAT(BuildTracks(given, false),
              UnorderedElementsAre(Track{{0, 0}, {1, 0}}, Track{{0, 1}, {1, 1}, {2, 0}}));
}

TEST(BuildTracks, SingleFramesNeedAStereoMatch) {
  Correspondences given = Frames(2, 2);
  given.features[1][1].right.reset();
  given.pairs = {{0, 1, {{0, 0}}}};
  EXPECT_THAT(BuildTracks(given, false), UnorderedElementsAre(Track{{0, 0}, {1, 0}}));
  EXPECT_THAT(BuildTracks(given, true), UnorderedElementsAre(Track{{0, 0}, {1, 0}}, Track{{0, 1}}));
  // A feature without stereo match still belongs to a track that others make.
  given.pairs = {{0, 1, {{0, 1}}}};
  EXPECT_THAT(BuildTracks(given, false), UnorderedElementsAre(Track{{0, 0}, {1, 1}}));
}

TEST(CutTracks, LeavesATrackForEachSide) {
  const std::vector<Track> tracks{
      {{0, 3}, {1, 4}, {2, 5}, {4, 6}}, {{0, 7}, {1, 8}}, {{3, 9}, {0, 1}}};
  EXPECT_THAT(CutTracks(tracks, {2, 4}),
              UnorderedElementsAre(Track{{0, 3}, {1, 4}}, Track{{2, 5}}, Track{{4, 6}},
                                   Track{{0, 7}, {1, 8}}, Track{{3, 9}}, Track{{0, 1}}));
  EXPECT_EQ(CutTracks(tracks, {}), tracks);
}

TEST(BuildTracks, NothingFromNothing) {
  EXPECT_TRUE(BuildTracks({}, true).empty());
  EXPECT_TRUE(BuildTracks(Frames(3, 0), true).empty());
}

TEST(BuildTracks, TrueMatchesGiveOneTrackPerPoint) {
  const SyntheticRover rover = MakeSyntheticRover({.frames = 6});
  const Correspondences given = RoverCorrespondences(rover, 2);
  const auto tracks = BuildTracks(given, true);
  std::set<FeatureRef> used;
  std::set<int> points;
  for (const Track& track : tracks) {
    std::set<int> of_track;
    for (const FeatureRef& ref : track) {
      EXPECT_TRUE(used.insert(ref).second);
      of_track.insert(rover.point_of_feature[ref.frame][ref.feature]);
    }
    ASSERT_EQ(of_track.size(), 1u);
    EXPECT_TRUE(std::is_sorted(track.begin(), track.end()));
    points.insert(*of_track.begin());
  }
  EXPECT_EQ(BuildTracks(given, true), tracks);
  EXPECT_GT(points.size(), 500u);
}

}  // namespace
}  // namespace rigmap
