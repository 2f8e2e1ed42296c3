#include "mapping/seed_model.h"

#include <gmock/gmock.h>

#include <map>
#include <set>

#include "tests/mapping/rover_part.h"

namespace rigmap {
namespace {

// Keyframes k and k + 1 share links[k] tracks.
KeyframeGraph ChainOf(const std::vector<int>& links) {
  KeyframeGraph graph;
  graph.keyframes.resize(links.size() + 1);
  for (std::size_t k = 0; k < links.size(); ++k) {
    const int first = static_cast<int>(k);
    for (int i = 0; i < links[k]; ++i) graph.tracks.push_back({{first, i}, {first + 1, i}});
  }
  return graph;
}

std::optional<int> BestOf(const std::vector<int>& links, int length) {
  return BestSeedStart(ChainOf(links), std::vector<bool>(links.size() + 1, true), length);
}

TEST(BestSeedStart, TakesTheRowWhoseWeakestLinkIsStrongest) {
  EXPECT_EQ(BestOf({40, 90, 41, 60, 60, 50}, 3), 3);
  EXPECT_EQ(BestOf({40, 90, 41, 60, 60, 50}, 2), 1);
  EXPECT_EQ(BestOf({40, 90, 41, 60, 60, 50}, 4), 3);
  EXPECT_EQ(BestOf({40, 90, 41, 60, 60, 50}, 7), 0);
  EXPECT_EQ(BestOf({50, 50, 50}, 2), 0);  // the first of equals
}

TEST(BestSeedStart, KeepsToWhatIsAllowed) {
  const KeyframeGraph graph = ChainOf({40, 90, 41, 60, 60, 50});
  std::vector<bool> allowed(7, true);
  EXPECT_EQ(BestSeedStart(graph, allowed, 3), 3);
  allowed[4] = false;
  EXPECT_EQ(BestSeedStart(graph, allowed, 3), 1);
  allowed[3] = false;
  EXPECT_EQ(BestSeedStart(graph, allowed, 3), 0);
  allowed[1] = false;
  EXPECT_EQ(BestSeedStart(graph, allowed, 3), std::nullopt);
  EXPECT_EQ(BestSeedStart(graph, allowed, 2), 5);
}

TEST(BestSeedStart, NeedsThirtyCommonTracksAtEveryLink) {
  EXPECT_EQ(BestOf({100, 29, 100}, 3), std::nullopt);
  EXPECT_EQ(BestOf({100, 30, 100}, 3), 0);
}

TEST(BestSeedStart, TracksThatSkipAKeyframeAreNoLink) {
  KeyframeGraph graph;
  graph.keyframes.resize(3);
  for (int i = 0; i < 100; ++i) graph.tracks.push_back({{0, i}, {2, i}});
  EXPECT_EQ(BestSeedStart(graph, {true, true, true}, 2), std::nullopt);
}

TEST(BestSeedStart, ARowThatDoesNotExistIsNone) {
  EXPECT_EQ(BestOf({100, 100}, 4), std::nullopt);
  EXPECT_EQ(BestSeedStart({}, {}, 0), std::nullopt);
  EXPECT_EQ(BestSeedStart({}, {}, 4), std::nullopt);
  EXPECT_EQ(BestSeedStart(ChainOf({100}), {true, true}, 1), std::nullopt);
}

class SeedModelTest : public testing::Test {
 protected:
  static RoverPart Part(double pixel_sigma) {
    return MakeRoverPart(
        {.frames = 7, .points_per_m2 = 12.0, .pixel_sigma = pixel_sigma, .seed = 5});
  }
};

// Point of the rover that a left keypoint shows.
int TruePoint(const RoverPart& part, const KeyframeGraph& graph, const TrackElement& element) {
  const GraphKeyframe& keyframe = graph.keyframes[element.image.frame];
  return part.rover.point_of_feature[keyframe.frame][keyframe.features[element.keypoint]];
}

TEST_F(SeedModelTest, WithoutNoisePointsAreTheTrueOnesInMetres) {
  const RoverPart part = Part(0.0);
  const KeyframeGraph graph = part.Graph({.tracks_per_keyframe = 300});
  const SparseModel model = MakeSeedModel(
      {graph, part.correspondences, part.rover.rig, KeyframePoses(graph, part.odometry)}, 2, 4);
  EXPECT_GT(model.points.size(), 200u);
  for (const SparsePoint& point : model.points) {
    ASSERT_EQ(point.track.front().image.eye, Eye::kLeft);
    const Eigen::Vector3d& x = part.rover.points[TruePoint(part, graph, point.track.front())];
    EXPECT_LT((point.x_in_model - x).norm(), 1e-6);  // m
  }
  ASSERT_EQ(model.images.size(), 8u);
  for (const SparseImage& image : model.images) {
    const Rigid3& left = part.rover.world_from_left[image.ref.frame];
    const Rigid3 camera_from_left =
        image.ref.eye == Eye::kLeft ? Rigid3() : part.rover.rig.right_from_left;
    const Rigid3 difference = image.camera_from_model * left * camera_from_left.Inverse();
    EXPECT_LT(difference.translation.norm(), 1e-9);  // m
    EXPECT_LT(AngleOf(difference.rotation), 1e-7);   // rad
  }
}

TEST_F(SeedModelTest, EveryPointReprojectsIntoItsKeypoints) {
  const RoverPart part = Part(0.2);
  const KeyframeGraph graph = part.Graph();
  const SparseModel model = MakeSeedModel(
      {graph, part.correspondences, part.rover.rig, KeyframePoses(graph, part.odometry)}, 0, 7);
  std::map<ImageRef, const SparseImage*> images;
  for (const SparseImage& image : model.images) images[image.ref] = &image;
  std::size_t elements = 0, named = 0;
  std::set<std::uint64_t> ids;
  for (const SparsePoint& point : model.points) {
    EXPECT_TRUE(ids.insert(point.id).second);
    ASSERT_GE(point.track.size(), 2u);
    for (const TrackElement& element : point.track) {
      const SparseImage& image = *images.at(element.image);
      const SparseKeypoint& keypoint = image.keypoints.at(element.keypoint);
      ASSERT_EQ(keypoint.point_id, point.id);
      const Camera& camera = part.rover.rig.Of(image.ref.eye).camera;
      const auto pixel = Project(camera, image.camera_from_model * point.x_in_model);
      ASSERT_TRUE(pixel);
      EXPECT_LT((*pixel - keypoint.pixel).norm(), 1.5);  // px, at 0.2 px noise
      ++elements;
    }
  }
  for (const SparseImage& image : model.images) {
    for (const SparseKeypoint& keypoint : image.keypoints) named += keypoint.point_id ? 1 : 0;
  }
  EXPECT_EQ(named, elements);
}

TEST_F(SeedModelTest, KeypointsAreTheDatabasesInNumberAndOrder) {
  const RoverPart part = Part(0.2);
  const KeyframeGraph graph = part.Graph({.tracks_per_keyframe = 100});
  const DatabaseContent content = MakeDatabaseContent(graph, part.correspondences, part.rover.rig);
  const SparseModel model = MakeSeedModel(
      {graph, part.correspondences, part.rover.rig, KeyframePoses(graph, part.odometry)}, 1, 4);
  ASSERT_EQ(model.images.size(), 8u);
  for (const SparseImage& image : model.images) {
    const DatabaseImage& in_database =
        content.images.at(2 * image.ref.frame + (image.ref.eye == Eye::kLeft ? 0 : 1));
    EXPECT_EQ(in_database.ref, image.ref);
    EXPECT_EQ(in_database.name, image.name);
    ASSERT_EQ(in_database.keypoints.size(), image.keypoints.size());
    for (std::size_t i = 0; i < image.keypoints.size(); ++i) {
      ASSERT_EQ(image.keypoints[i].pixel.cast<float>(), in_database.keypoints[i]);
    }
  }
}

TEST_F(SeedModelTest, ATrackWithAWrongPixelIsLeftOut) {
  RoverPart part = Part(0.0);
  const KeyframeGraph graph = part.Graph();
  const Track& spoiled = graph.tracks.front();
  const GraphKeyframe& keyframe = graph.keyframes[spoiled.front().frame];
  const int feature = keyframe.features[spoiled.front().feature];
  part.correspondences.features[keyframe.frame][feature].left += Eigen::Vector2d(15.0, 15.0);
  const SparseModel model = MakeSeedModel(
      {graph, part.correspondences, part.rover.rig, KeyframePoses(graph, part.odometry)}, 0, 7);
  EXPECT_EQ(model.points.size(), graph.tracks.size() - 1);
  const SparseImage& image = model.images[2 * spoiled.front().frame];
  EXPECT_FALSE(image.keypoints[spoiled.front().feature].point_id);
}

TEST_F(SeedModelTest, MovesWithThePoses) {
  SeededRandom random;
  const RoverPart part = Part(0.2);
  const KeyframeGraph graph = part.Graph();
  const Rigid3 moved_from_world = random.Motion(30.0);
  auto poses = KeyframePoses(graph, part.odometry);
  const SparseModel here =
      MakeSeedModel({graph, part.correspondences, part.rover.rig, poses}, 0, 4);
  for (Rigid3& pose : poses) pose = moved_from_world * pose;
  const SparseModel there =
      MakeSeedModel({graph, part.correspondences, part.rover.rig, poses}, 0, 4);
  ASSERT_EQ(here.points.size(), there.points.size());
  for (std::size_t i = 0; i < here.points.size(); ++i) {
    const Eigen::Vector3d expected = moved_from_world * here.points[i].x_in_model;
    ASSERT_LT((there.points[i].x_in_model - expected).norm(), 1e-6);  // m
  }
}

}  // namespace
}  // namespace rigmap
