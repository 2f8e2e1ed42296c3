#include "correspondence/sightings.h"

#include <gtest/gtest.h>

#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

// A rover without noise: what is predicted and what is seen are the same.
class SightingsTest : public testing::Test {
 protected:
  SightingsTest() {
    for (const auto& [a, b] : TrueMatches(rover_, 0, 1)) matches_.push_back({a, b});
  }

  const SyntheticRover rover_ = MakeSyntheticRover({.frames = 2, .pixel_sigma = 0.0});
  const std::vector<Feature>&a_ = rover_.frames[0].features, &b_ = rover_.frames[1].features;
  const Rigid3 b_from_a_ = rover_.world_from_left[1].Inverse() * rover_.world_from_left[0];
  std::vector<std::optional<StereoPoint>> points_ = TriangulateFeatures(a_, rover_.rig, 0.3);
  std::vector<FeatureMatch> matches_;
};

TEST_F(SightingsTest, PointsArePredictedWhereTheyAreSeen) {
  const auto predicted = PredictedPixels(points_, b_from_a_, rover_.rig);
  ASSERT_EQ(predicted.size(), a_.size());
  int compared = 0;
  for (const FeatureMatch& match : matches_) {
    ASSERT_EQ(predicted[match.a].has_value(), points_[match.a].has_value());
    if (!predicted[match.a]) continue;
    EXPECT_LT((*predicted[match.a] - b_[match.b].left).norm(), 0.01);
    ++compared;
  }
  EXPECT_GT(compared, 100);
}

TEST_F(SightingsTest, PointsBehindAreNotPredicted) {
  const Rigid3 beyond{Eigen::Quaterniond::Identity(), Eigen::Vector3d(0.0, 0.0, -100.0)};
  for (const auto& pixel : PredictedPixels(points_, beyond, rover_.rig)) EXPECT_FALSE(pixel);
}

TEST_F(SightingsTest, FitTheMotionInBothEyes) {
  const MatchedSightings found = SightingsOf(matches_, points_, b_, rover_.rig);
  ASSERT_EQ(found.matches.size(), found.sightings.size());
  int in_both = 0;
  for (const PointSighting& sighting : found.sightings) {
    const Eigen::Vector3d in_b = b_from_a_ * sighting.x_in_reference;
    EXPECT_LT((in_b.hnormalized() - sighting.left).norm(), 1e-5);
    if (!sighting.right) continue;
    const Eigen::Vector3d in_right = rover_.rig.right_from_left * in_b;
    EXPECT_LT((in_right.hnormalized() - *sighting.right).norm(), 1e-5);
    ++in_both;
  }
  EXPECT_GT(in_both, 100);
}

TEST_F(SightingsTest, MatchesWithoutPointAreLeftOut) {
  const std::size_t all = SightingsOf(matches_, points_, b_, rover_.rig).matches.size();
  std::size_t first = 0;
  while (!points_[matches_[first].a]) ++first;
  points_[matches_[first].a].reset();
  const MatchedSightings found = SightingsOf(matches_, points_, b_, rover_.rig);
  EXPECT_EQ(found.matches.size(), all - 1);
  for (const FeatureMatch& match : found.matches) EXPECT_NE(match.a, matches_[first].a);
}

TEST_F(SightingsTest, AgreeingAreThoseOfThePosesInliers) {
  const MatchedSightings found = SightingsOf(matches_, points_, b_, rover_.rig);
  StereoPose pose;
  pose.inliers.assign(found.matches.size(), false);
  pose.inliers[1] = pose.inliers[4] = true;
  const std::vector<FeatureMatch> agreeing = found.Agreeing(pose);
  ASSERT_EQ(agreeing.size(), 2u);
  EXPECT_EQ(agreeing[0].a, found.matches[1].a);
  EXPECT_EQ(agreeing[1].b, found.matches[4].b);
}

}  // namespace
}  // namespace rigmap
