#include "mapping/build_graph.h"

#include <gmock/gmock.h>

#include <map>
#include <set>

#include "correspondence/tracks.h"
#include "tests/colmap/read_database.h"
#include "tests/mapping/rover_part.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

using PixelKey = std::pair<float, float>;

PixelKey KeyOf(const Eigen::Vector2f& pixel) { return {pixel.x(), pixel.y()}; }

// Which point of the rover each pixel of an image shows; no two features share a pixel.
std::map<PixelKey, int> PointsOfPixels(const SyntheticRover& rover, int frame, Eye eye) {
  std::map<PixelKey, int> points;
  const auto& features = rover.frames[frame].features;
  for (std::size_t i = 0; i < features.size(); ++i) {
    const int point = rover.point_of_feature[frame][i];
    if (eye == Eye::kLeft) points[KeyOf(features[i].left.cast<float>())] = point;
    if (eye == Eye::kRight && features[i].right) {
      points[KeyOf(features[i].right->cast<float>())] = point;
    }
  }
  return points;
}

// Point of every keypoint, by image. Fails where a keypoint is none of its image's pixels.
std::map<ImageRef, std::vector<int>> PointsOfKeypoints(const DatabaseContent& content,
                                                       const KeyframeGraph& graph,
                                                       const SyntheticRover& rover) {
  std::map<ImageRef, std::vector<int>> result;
  for (const DatabaseImage& image : content.images) {
    const int frame = graph.keyframes.at(image.ref.frame).frame;
    const auto points = PointsOfPixels(rover, frame, image.ref.eye);
    for (const auto& keypoint : image.keypoints) {
      result[image.ref].push_back(points.at(KeyOf(keypoint)));
    }
  }
  return result;
}

// Tracks per keyframe.
std::vector<int> TrackCounts(const KeyframeGraph& graph) {
  std::vector<int> counts(graph.keyframes.size(), 0);
  for (const Track& track : graph.tracks) {
    for (const FeatureRef& ref : track) ++counts[ref.frame];
  }
  return counts;
}

class BuildGraphTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    part_ = MakeRoverPart({.frames = 10, .points_per_m2 = 12.0, .seed = 3});
    for (int i : {1, 4, 5}) part_.odometry[i].keyframe = false;
  }

  static RoverPart part_;
};

RoverPart BuildGraphTest::part_;

TEST_F(BuildGraphTest, KeyframesAreTheOdometrysNamedByStampAndExtension) {
  const KeyframeGraph graph = part_.Graph();
  const std::vector<int> frames{0, 2, 3, 6, 7, 8, 9};
  ASSERT_EQ(graph.keyframes.size(), frames.size());
  for (std::size_t k = 0; k < frames.size(); ++k) {
    EXPECT_EQ(graph.keyframes[k].frame, frames[k]);
    const std::string stamp = std::to_string(part_.rover.frames[frames[k]].stamp_ns);
    EXPECT_EQ(graph.keyframes[k].left_name, "left/" + stamp + ".png");
    EXPECT_EQ(graph.keyframes[k].right_name, "right/" + stamp + ".png");
  }
}

TEST_F(BuildGraphTest, EveryMatchNamesTheSamePoint) {
  const KeyframeGraph graph = part_.Graph({.tracks_per_keyframe = 150});
  const DatabaseContent content =
      MakeDatabaseContent(graph, part_.correspondences, part_.rover.rig);
  const auto points = PointsOfKeypoints(content, graph, part_.rover);
  std::size_t stereo = 0, between = 0;
  for (const DatabasePair& pair : content.pairs) {
    for (const auto& [a, b] : pair.matches) {
      ASSERT_EQ(points.at(pair.image_a).at(a), points.at(pair.image_b).at(b));
    }
    (pair.image_a.frame == pair.image_b.frame ? stereo : between) += pair.matches.size();
  }
  EXPECT_GT(stereo, 7u * 100u);
  EXPECT_GT(between, 6u * 100u);
}

TEST_F(BuildGraphTest, EveryTrackNamesOnePointInDifferentKeyframes) {
  const KeyframeGraph graph = part_.Graph();
  for (const Track& track : graph.tracks) {
    std::set<int> points, keyframes;
    for (const auto& [keyframe, keypoint] : track) {
      const GraphKeyframe& of = graph.keyframes.at(keyframe);
      points.insert(part_.rover.point_of_feature[of.frame].at(of.features.at(keypoint)));
      keyframes.insert(keyframe);
    }
    ASSERT_EQ(points.size(), 1u);
    ASSERT_GE(keyframes.size(), 2u);
    ASSERT_EQ(keyframes.size(), track.size());
  }
}

TEST_F(BuildGraphTest, AKeypointIsAFeatureOnceWithItsOwnStereoMatch) {
  const KeyframeGraph graph = part_.Graph();
  for (const GraphKeyframe& keyframe : graph.keyframes) {
    ASSERT_EQ(keyframe.features.size(), keyframe.right_keypoints.size());
    EXPECT_EQ(std::set<int>(keyframe.features.begin(), keyframe.features.end()).size(),
              keyframe.features.size());
    std::uint32_t next = 0;
    for (std::size_t i = 0; i < keyframe.features.size(); ++i) {
      const auto& feature = part_.rover.frames[keyframe.frame].features[keyframe.features[i]];
      ASSERT_EQ(keyframe.right_keypoints[i].has_value(), feature.right.has_value());
      if (!feature.right) continue;
      ASSERT_EQ(*keyframe.right_keypoints[i], next++);
    }
  }
}

TEST_F(BuildGraphTest, EveryKeyframeThatCanHasItsShareOfTheLongest) {
  const KeyframeGraph all = part_.Graph({.tracks_per_keyframe = 1'000'000});
  const std::vector<int> available = TrackCounts(all);
  std::size_t fewer = 0;
  for (int share : {50, 100, 200}) {
    const KeyframeGraph graph = part_.Graph({.tracks_per_keyframe = share});
    const std::vector<int> counts = TrackCounts(graph);
    for (std::size_t k = 0; k < counts.size(); ++k) {
      EXPECT_GE(counts[k], std::min(share, available[k])) << "keyframe " << k;
      EXPECT_EQ(counts[k], static_cast<int>(graph.keyframes[k].features.size()));
    }
    EXPECT_GT(graph.tracks.size(), fewer);
    EXPECT_LT(graph.tracks.size(), all.tracks.size());
    fewer = graph.tracks.size();
    for (std::size_t i = 1; i < graph.tracks.size(); ++i) {
      ASSERT_LE(graph.tracks[i].size(), graph.tracks[i - 1].size());
    }
    // Full-length tracks come first: a shorter one was taken only for a keyframe in need.
    EXPECT_EQ(graph.tracks.front().size(), all.tracks.front().size());
  }
}

TEST_F(BuildGraphTest, WithoutLimitEveryTrackOverKeyframesIsTaken) {
  const KeyframeGraph graph = part_.Graph({.tracks_per_keyframe = 1'000'000});
  std::size_t expected = 0;
  for (const Track& track : BuildTracks(part_.correspondences, false)) {
    int keyframes = 0, stereo_matches = 0;
    for (const auto& [frame, feature] : track) {
      if (!part_.odometry[frame].keyframe) continue;
      ++keyframes;
      stereo_matches += part_.correspondences.features[frame][feature].right ? 1 : 0;
    }
    expected += keyframes >= 2 && stereo_matches > 0 ? 1 : 0;
  }
  EXPECT_EQ(graph.tracks.size(), expected);
  EXPECT_GT(expected, 300u);
}

TEST_F(BuildGraphTest, APointThatNoPairShowsInStereoIsNotUsed) {
  RoverPart part = part_;
  for (auto& frame : part.correspondences.features) {
    for (Feature& feature : frame) feature.right.reset();
  }
  EXPECT_TRUE(part.Graph().tracks.empty());
}

TEST_F(BuildGraphTest, TheDatabaseTakesItAndGivesItBack) {
  const TemporaryFolder folder;
  const KeyframeGraph graph = part_.Graph();
  const DatabaseContent content =
      MakeDatabaseContent(graph, part_.correspondences, part_.rover.rig);
  WriteDatabase(FindColmap(), content, folder.Path() / "database.db", folder.Path() / "log");
  const DatabaseContent read = ReadDatabase(folder.Path() / "database.db");
  ASSERT_EQ(read.images.size(), content.images.size());
  for (std::size_t i = 0; i < read.images.size(); ++i) {
    EXPECT_EQ(read.images[i].ref, content.images[i].ref);
    EXPECT_EQ(read.images[i].name, content.images[i].name);
    ASSERT_EQ(read.images[i].keypoints.size(), content.images[i].keypoints.size());
    for (std::size_t j = 0; j < read.images[i].keypoints.size(); ++j) {
      const Eigen::Vector2f moved = read.images[i].keypoints[j] - content.images[i].keypoints[j];
      ASSERT_LT(moved.norm(),
                1e-4);  // px: half a pixel is added and taken away in single precision
    }
  }
  const auto count = [](const DatabaseContent& of) {
    std::size_t matches = 0;
    for (const DatabasePair& pair : of.pairs) matches += pair.matches.size();
    return matches;
  };
  EXPECT_EQ(count(read), count(content));
}

TEST_F(BuildGraphTest, CamerasAreTheRigs) {
  const DatabaseContent content =
      MakeDatabaseContent(part_.Graph(), part_.correspondences, part_.rover.rig);
  ASSERT_EQ(content.cameras.size(), 2u);
  EXPECT_EQ(content.cameras[0].eye, Eye::kLeft);
  EXPECT_EQ(content.cameras[0].camera.fx, part_.rover.rig.left.camera.fx);
  EXPECT_EQ(content.cameras[1].eye, Eye::kRight);
  EXPECT_EQ(content.cameras[1].camera.fx, part_.rover.rig.right.camera.fx);
}

TEST_F(BuildGraphTest, KeyframesWithoutMatchesStay) {
  RoverPart part = part_;
  part.correspondences.pairs.clear();
  const KeyframeGraph graph = part.Graph();
  EXPECT_EQ(graph.keyframes.size(), 7u);
  EXPECT_TRUE(graph.tracks.empty());
  const DatabaseContent content = MakeDatabaseContent(graph, part.correspondences, part.rover.rig);
  EXPECT_EQ(content.images.size(), 14u);
}

}  // namespace
}  // namespace rigmap
