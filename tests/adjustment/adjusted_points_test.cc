#include "adjustment/internal/adjusted_points.h"

#include <gmock/gmock.h>

#include "tests/adjustment/rover_bundle.h"

namespace rigmap {
namespace {

constexpr double kWide_px = 8.0;
constexpr double kFar_m = 100.0;

class AdjustedPointsTest : public testing::Test {
 protected:
  void Make(double pixel_sigma) {
    rover_ = MakeSyntheticRover(
        {.frames = 6, .points_per_m2 = 10.0, .pixel_sigma = pixel_sigma, .seed = 41});
    correspondences_ = RoverCorrespondences(rover_, 3);
    tracks_ = BuildTracks(correspondences_, false);
    left_from_world_ = InverseOf(AllOf(rover_.world_from_left));
  }

  std::vector<AdjustedPoint> Triangulated(double max_error_px, double max_depth_m = kFar_m) const {
    return TriangulateTracks(tracks_, correspondences_, rover_.rig, left_from_world_, max_error_px,
                             max_depth_m);
  }

  std::size_t ObservationsOf(const Track& track) const {
    std::size_t count = 0;
    for (const auto& [frame, feature] : track) {
      if (!left_from_world_[frame]) continue;
      count += correspondences_.features[frame][feature].right ? 2 : 1;
    }
    return count;
  }

  double ErrorPx(const AdjustedPoint& point, const PointObservation& observation) const {
    const Rigid3 eye_from_left =
        observation.eye == Eye::kLeft ? Rigid3() : rover_.rig.right_from_left;
    const Rigid3 eye_from_world = eye_from_left * *left_from_world_[observation.frame];
    const auto pixel = Project(rover_.rig.Of(observation.eye).camera, eye_from_world * point.x);
    return (pixel.value() - observation.pixel).norm();
  }

  SyntheticRover rover_;
  Correspondences correspondences_;
  std::vector<Track> tracks_;
  MaybePoses left_from_world_;
};

TEST_F(AdjustedPointsTest, WithoutNoisePointsAreTheTrueOnesWithAllObservations) {
  Make(0.0);
  const auto points = Triangulated(0.01);
  ASSERT_EQ(points.size(), tracks_.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_LT((points[i].x - TruePoint(rover_, points[i])).norm(), 1e-6);  // m
    EXPECT_EQ(points[i].observations.size(), ObservationsOf(tracks_[i]));
    for (const PointObservation& o : points[i].observations) {
      const Feature& feature = correspondences_.features[o.frame][o.feature];
      ASSERT_EQ(o.pixel, o.eye == Eye::kLeft ? feature.left : Eigen::Vector2d(*feature.right));
    }
  }
}

TEST_F(AdjustedPointsTest, FramesWithoutAPoseArePassedOver) {
  Make(0.0);
  const std::size_t all = Triangulated(kWide_px).size();
  for (int frame : {0, 3, 4}) left_from_world_[frame].reset();
  const auto points = Triangulated(kWide_px);
  EXPECT_LT(points.size(), all);
  EXPECT_GT(points.size(), 50u);
  for (const AdjustedPoint& point : points) {
    EXPECT_TRUE(SpansFrames(point));
    for (const PointObservation& o : point.observations) ASSERT_TRUE(left_from_world_[o.frame]);
  }
  for (int frame : {1, 2}) left_from_world_[frame].reset();
  EXPECT_TRUE(Triangulated(kWide_px).empty());  // one frame alone
}

TEST_F(AdjustedPointsTest, AWrongPixelIsDroppedAndTheRestOfItsTrackStays) {
  Make(0.2);
  const auto before = Triangulated(kWide_px);
  ASSERT_EQ(before.size(), tracks_.size());
  int spoiled = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (before[i].observations.size() < 8) continue;
    const FeatureRef& ref = tracks_[i][1];
    correspondences_.features[ref.frame][ref.feature].left += Eigen::Vector2d(14.0, -14.0);
    ++spoiled;
  }
  ASSERT_GT(spoiled, 50);
  const auto after = Triangulated(kWide_px);
  ASSERT_EQ(after.size(), before.size());
  int dropped = 0;
  for (std::size_t i = 0; i < after.size(); ++i) {
    const bool is_spoiled = before[i].observations.size() >= 8;
    const std::size_t fewer = before[i].observations.size() - after[i].observations.size();
    EXPECT_EQ(fewer, is_spoiled ? 1u : 0u);
    dropped += static_cast<int>(fewer);
    for (const PointObservation& o : after[i].observations) {
      const bool is_wrong = o.eye == Eye::kLeft && o.frame == tracks_[i][1].frame;
      EXPECT_FALSE(is_spoiled && is_wrong);
    }
  }
  EXPECT_EQ(dropped, spoiled);
}

TEST_F(AdjustedPointsTest, NothingFurtherFromItsImageThanTheLimitIsLeft) {
  Make(0.2);
  SeededRandom random;
  // Poses wrong by some 20 px.
  left_from_world_ = InverseOf(AllOf(DriftingPoses(rover_, 0.02, 0.5 * kDegree, random)));
  std::size_t fewer = 0;
  for (double limit_px : {1.0, 4.0, 20.0, 1e9}) {
    const auto points = Triangulated(limit_px);
    std::size_t observations = 0;
    for (const AdjustedPoint& point : points) {
      EXPECT_TRUE(SpansFrames(point));
      observations += point.observations.size();
      for (const PointObservation& o : point.observations) {
        EXPECT_LE(ErrorPx(point, o), limit_px + 1e-9);
      }
    }
    EXPECT_GT(observations, fewer);
    fewer = observations;
  }
}

TEST_F(AdjustedPointsTest, WhatIsBeyondTheDepthLimitIsLeftOut) {
  Make(0.0);
  const auto all = Triangulated(kWide_px);
  const auto near = Triangulated(kWide_px, 4.0);
  const auto is_near = [&](const AdjustedPoint& point) {
    return (*left_from_world_[point.observations.front().frame] * point.x).norm() <= 4.0;
  };
  EXPECT_EQ(static_cast<std::ptrdiff_t>(near.size()),
            std::count_if(all.begin(), all.end(), is_near));
  EXPECT_GT(near.size(), 20u);
  EXPECT_LT(near.size(), all.size());
}

TEST_F(AdjustedPointsTest, PointsMoveWithTheWorld) {
  Make(0.2);
  SeededRandom random;
  const auto here = Triangulated(kWide_px);
  const Rigid3 moved_from_world = random.Motion(20.0);
  for (auto& pose : left_from_world_) pose = *pose * moved_from_world.Inverse();
  const auto there = Triangulated(kWide_px);
  ASSERT_EQ(here.size(), there.size());
  for (std::size_t i = 0; i < here.size(); ++i) {
    ASSERT_LT((there[i].x - moved_from_world * here[i].x).norm(), 1e-6);  // m
  }
}

// The rig stands while frames 2 and 3 are taken.
TEST_F(AdjustedPointsTest, WhatOneEyeOfAStandingRigShowsHasNoDepth) {
  Make(0.0);
  left_from_world_[3] = left_from_world_[2];
  left_from_world_[3]->translation.x() += 1e-5;
  AdjustedPoint point;
  point.observations = {{2, 0, Eye::kLeft, {}}, {3, 0, Eye::kLeft, {}}};
  EXPECT_TRUE(SpansFrames(point));
  EXPECT_FALSE(IsDetermined(point, rover_.rig, left_from_world_));
  point.observations.push_back({3, 0, Eye::kRight, {}});
  EXPECT_TRUE(IsDetermined(point, rover_.rig, left_from_world_));
  point.observations.back() = {4, 0, Eye::kLeft, {}};
  EXPECT_TRUE(IsDetermined(point, rover_.rig, left_from_world_));

  // One track that only these two frames show, in the left eye, is no point.
  for (auto& feature : correspondences_.features[2]) feature.right.reset();
  for (auto& feature : correspondences_.features[3]) feature.right.reset();
  for (const int frame : {0, 1, 4, 5}) left_from_world_[frame].reset();
  EXPECT_TRUE(Triangulated(1e9).empty());
}

TEST(SpansFrames, TakesTwoFramesNotTwoEyes) {
  AdjustedPoint point;
  EXPECT_FALSE(SpansFrames(point));
  point.observations = {{.frame = 2, .eye = Eye::kLeft}, {.frame = 2, .eye = Eye::kRight}};
  EXPECT_FALSE(SpansFrames(point));
  point.observations.push_back({.frame = 3});
  EXPECT_TRUE(SpansFrames(point));
}

}  // namespace
}  // namespace rigmap
