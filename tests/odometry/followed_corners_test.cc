#include "odometry/followed_corners.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/support/rover_correspondences.h"
#include "tests/support/synthetic_rover.h"
#include "trajectory/lost_frames.h"

namespace rigmap {
namespace {

constexpr int kFrames = 6, kLost = 3;

// A drive whose odometry has lost its way before frame kLost: what follows hangs on a guess.
class FollowedCornersTest : public testing::Test {
 protected:
  void SetUp() override {
    std::vector<Rigid3> poses;
    for (int i = 0; i < kFrames; ++i) poses.push_back(TruePose(i));
    odometry_ = OdometryOfKeyframes(rover_, poses);
    Lose(kLost);
  }

  // Relative to the first frame, as an odometry has it.
  Rigid3 TruePose(int frame) const {
    return rover_.world_from_left[0].Inverse() * rover_.world_from_left[frame];
  }

  void Lose(int frame) {
    const Rigid3 guessed_wrongly{ExpRotation({0.0, 0.1, 0.0}), {0.2, 0.0, -0.3}};
    odometry_[frame].source = PoseSource::kPredicted;
    for (int i = frame; i < kFrames; ++i) {
      odometry_[i].world_from_left = guessed_wrongly * odometry_[i].world_from_left;
    }
  }

  FrameFeatures Corners(int frame) const {
    FrameFeatures corners = rover_.frames[frame];
    corners.descriptors.clear();
    for (const int point : rover_.point_of_feature[frame]) corners.tracks.push_back(point);
    return corners;
  }

  Odometry Bridged() {
    return BridgeByCorners(odometry_,
                           [this](int from, int to) {
                             asked_.insert(to);
                             if (blank_.contains(from) || blank_.contains(to))
                               return FollowedCorners{};
                             FollowedCorners corners{Corners(from), Corners(to)};
                             for (std::size_t i = 0; i < corners.to.tracks.size(); ++i) {
                               const bool is_mixed_up =
                                   static_cast<double>(i % 10) < 10.0 * mixed_up_share_;
                               if (is_mixed_up) corners.to.tracks[i] = corners.from.tracks[i / 2];
                             }
                             return corners;
                           },
                           rover_.rig, {});
  }

  static void ExpectNear(const Rigid3& found, const Rigid3& expected) {
    EXPECT_LT((found.translation - expected.translation).norm(), 0.01);
    EXPECT_LT(LogRotation((found * expected.Inverse()).rotation).norm(), 0.004);
  }

  const SyntheticRover rover_ = MakeSyntheticRover({.frames = kFrames});
  Odometry odometry_;
  std::set<int> blank_;
  double mixed_up_share_ = 0.0;
  std::set<int> asked_;
};

TEST_F(FollowedCornersTest, PosesALostFrameAndWhatHangsOnIt) {
  const Odometry bridged = Bridged();
  EXPECT_TRUE(LostFrames(bridged).empty());
  EXPECT_EQ(bridged[kLost].source, PoseSource::kOdometry);
  EXPECT_EQ(bridged[kLost].reference, kLost - 1);
  EXPECT_GT(bridged[kLost].inliers, 50);
  EXPECT_GT(bridged[kLost].step_covariance.trace(), 0.0);
  for (int i = 0; i < kFrames; ++i) ExpectNear(bridged[i].world_from_left, TruePose(i));
  EXPECT_EQ(asked_, std::set<int>{kLost});
}

TEST_F(FollowedCornersTest, ReachesAcrossFramesThatShowNothing) {
  Lose(kLost + 1);
  blank_ = {kLost};
  const Odometry bridged = Bridged();
  EXPECT_EQ(bridged[kLost].source, PoseSource::kPredicted);
  EXPECT_EQ(bridged[kLost + 1].source, PoseSource::kOdometry);
  EXPECT_EQ(bridged[kLost + 1].reference, kLost - 1);
  EXPECT_TRUE(LostFrames(bridged).empty()) << "what lies between is held from both sides";
  ExpectNear(bridged[kFrames - 1].world_from_left, TruePose(kFrames - 1));
}

TEST_F(FollowedCornersTest, LeavesAloneWhatMostCornersContradict) {
  mixed_up_share_ = 0.8;
  const Odometry bridged = Bridged();
  EXPECT_EQ(bridged[kLost].source, PoseSource::kPredicted);
  ExpectNear(bridged[kFrames - 1].world_from_left, odometry_[kFrames - 1].world_from_left);
}

TEST_F(FollowedCornersTest, AsksNothingWhereNothingIsLost) {
  odometry_[kLost].source = PoseSource::kOdometry;
  const Odometry bridged = Bridged();
  EXPECT_TRUE(asked_.empty());
  ExpectNear(bridged[kLost].world_from_left, odometry_[kLost].world_from_left);
}

}  // namespace
}  // namespace rigmap
