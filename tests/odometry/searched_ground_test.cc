#include "odometry/searched_ground.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/support/rover_correspondences.h"
#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

// A drive over textured ground of which wheels and gyro pose frame kBridged, some centimetres off.
class SearchedGroundTest : public testing::Test {
 protected:
  static constexpr int kFrames = 6, kBridged = 3;

  void SetUp() override {
    std::vector<Rigid3> poses;
    for (int i = 0; i < kFrames; ++i) poses.push_back(TruePose(i));
    odometry_ = OdometryOfKeyframes(rover_, poses);
    odometry_[kBridged].bridged = true;
    odometry_[kBridged].step_covariance = 0.03 * 0.03 * Matrix6d::Identity();
    Move({ExpRotation({0.0, 0.002, 0.001}), {0.01, 0.0, 0.015}});
  }

  // Relative to the first frame, as an odometry has it.
  Rigid3 TruePose(int frame) const {
    return rover_.world_from_left[0].Inverse() * rover_.world_from_left[frame];
  }

  // All from frame kBridged on, in the axes of the frame before.
  void Move(const Rigid3& by) {
    const Rigid3 before = odometry_[kBridged - 1].world_from_left;
    for (int i = kBridged; i < kFrames; ++i) {
      odometry_[i].world_from_left = before * by * before.Inverse() * odometry_[i].world_from_left;
    }
  }

  Odometry Bridged() {
    return BridgeBySearch(
        odometry_, [this](int frame) { return rover_.frames[frame]; },
        [this](int frame, const std::vector<Eigen::Vector2d>& pixels) {
          asked_.insert(frame);
          if (without_images_ || frame == without_)
            return std::vector<std::optional<SampledFeature>>{};
          return SampleFeatures(rover_, frame, pixels);
        },
        rover_.rig, {});
  }

  static double OffM(const Odometry& odometry, const SearchedGroundTest& test, int frame) {
    return (odometry[frame].world_from_left.translation - test.TruePose(frame).translation).norm();
  }

  const SyntheticRover rover_ = MakeSyntheticRover({.frames = kFrames,
                                                    .step_m = 0.4,
                                                    .points_per_m2 = 12.0,
                                                    .pixel_sigma = 0.2,
                                                    .textured_patches = true});
  Odometry odometry_;
  bool without_images_ = false;
  int without_ = -1;  // a frame without images
  std::set<int> asked_;
};

TEST_F(SearchedGroundTest, PosesABridgedFrameByItsImagesAndWhatHangsOnIt) {
  ASSERT_GT(OffM(odometry_, *this, kFrames - 1), 0.015);
  const Odometry found = Bridged();
  EXPECT_EQ(asked_, (std::set<int>{kBridged}));
  EXPECT_FALSE(found[kBridged].bridged);
  EXPECT_EQ(found[kBridged].source, PoseSource::kOdometry);
  EXPECT_EQ(found[kBridged].reference, kBridged - 1);
  EXPECT_GE(found[kBridged].inliers, 30);
  for (int i = 0; i < kBridged; ++i) EXPECT_LT(OffM(found, *this, i), 1e-12);
  for (int i = kBridged; i < kFrames; ++i) EXPECT_LT(OffM(found, *this, i), 0.005) << i;
}

TEST_F(SearchedGroundTest, IsAsSureAsItIsRight) {
  const Odometry found = Bridged();
  const Rigid3 step = OdometricStep(found, kBridged - 1, kBridged);
  const Rigid3 truth = TruePose(kBridged - 1).Inverse() * TruePose(kBridged);
  // A left perturbation of left_from_reference, whose translation is in the later frame's axes.
  const Rigid3 error = step.Inverse() * truth;
  Vector6d off;
  off << error.translation, LogRotation(error.rotation);
  const double squares = off.dot(found[kBridged].step_covariance.ldlt().solve(off));
  EXPECT_LT(squares, 22.5);  // of six, one in a thousand exceeds it
  EXPECT_LT(std::sqrt(found[kBridged].step_covariance.topLeftCorner<3, 3>().trace()), 0.02);
}

TEST_F(SearchedGroundTest, PosesAFrameThatWasGuessed) {
  odometry_[kBridged].bridged = false;
  odometry_[kBridged].source = PoseSource::kPredicted;
  const Odometry found = Bridged();
  EXPECT_EQ(found[kBridged].source, PoseSource::kOdometry);
  EXPECT_LT(OffM(found, *this, kFrames - 1), 0.005);
}

// Sensors know frame 4 against frame 2; frame 3 between them is a guess, and cannot be searched.
TEST_F(SearchedGroundTest, HangsNothingThatSensorsKnowOnAGuess) {
  odometry_[kBridged].bridged = false;
  odometry_[kBridged].source = PoseSource::kPredicted;
  odometry_[kBridged + 1].bridged = true;
  odometry_[kBridged + 1].reference = kBridged - 1;
  odometry_[kBridged + 1].step_covariance = 0.03 * 0.03 * Matrix6d::Identity();
  without_ = kBridged;
  const Odometry found = Bridged();
  EXPECT_EQ(found[kBridged].source, PoseSource::kPredicted);
  EXPECT_FALSE(found[kBridged + 1].bridged);
  EXPECT_EQ(found[kBridged + 1].reference, kBridged - 1);
  EXPECT_LT(OffM(found, *this, kFrames - 1), 0.008);
}

TEST_F(SearchedGroundTest, LeavesWhatSensorsKnowBetter) {
  odometry_[kBridged].step_covariance = 1e-8 * Matrix6d::Identity();
  const Odometry found = Bridged();
  EXPECT_TRUE(found[kBridged].bridged);
  EXPECT_LT((found[kBridged].world_from_left.translation -
             odometry_[kBridged].world_from_left.translation)
                .norm(),
            1e-12);
}

TEST_F(SearchedGroundTest, FindsNothingFarFromWhereItSearches) {
  Move({ExpRotation({0.0, 0.05, 0.0}), Eigen::Vector3d::Zero()});  // 40 px
  const Odometry found = Bridged();
  EXPECT_TRUE(found[kBridged].bridged);
  EXPECT_NEAR(OffM(found, *this, kBridged), OffM(odometry_, *this, kBridged), 1e-9);
}

TEST_F(SearchedGroundTest, LeavesAllAsItIsWithoutImages) {
  without_images_ = true;
  const Odometry found = Bridged();
  EXPECT_TRUE(found[kBridged].bridged);
  for (int i = 0; i < kFrames; ++i) {
    EXPECT_NEAR(OffM(found, *this, i), OffM(odometry_, *this, i), 1e-12);
  }
}

TEST_F(SearchedGroundTest, AsksForNothingWhereImagesLedAllTheWay) {
  odometry_[kBridged].bridged = false;
  Bridged();
  EXPECT_TRUE(asked_.empty());
}

}  // namespace
}  // namespace rigmap
