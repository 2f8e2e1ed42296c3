#include "dense/frames_for_depth.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

namespace rigmap {
namespace {

using testing::ElementsAre;
using testing::ElementsAreArray;

constexpr double kNear_m = 2.0, kVoxel_m = 0.01;

// A camera that looks down on ground 1 m below it and drives along its image's height: the ground
// passes by 1000 px a metre, of 900 px, so that 0.1 m is a ninth of the image.
struct Drive {
  Camera camera{1200, 900, 1000.0, 1000.0, 600.0, 450.0};
  Trajectory trajectory;
  std::vector<std::vector<Eigen::Vector3d>> points_in_left;
  std::vector<int> unreadable;

  void DriveOn(int frames, double step_m, int keyframe_every) {
    for (int i = 0; i < frames; ++i) {
      TimedPose pose{.source = PoseSource::kAdjusted};
      const double y_m =
          trajectory.empty() ? 0.0 : trajectory.back().world_from_left.translation.y();
      pose.world_from_left.translation = {0.0, y_m + step_m, 0.0};
      pose.keyframe = i % keyframe_every == 0;
      trajectory.push_back(pose);
      std::vector<Eigen::Vector3d> points;
      for (int p = 0; pose.keyframe && p < 50; ++p) points.push_back({0.0, 0.4 - 0.016 * p, 1.0});
      points_in_left.push_back(points);
    }
  }

  std::vector<int> Frames() const {
    return FramesForDepth({trajectory, camera, points_in_left, unreadable}, kNear_m, kVoxel_m);
  }
};

TEST(FramesForDepthTest, AreThoseBetweenKeyframesWithoutWhichTooMuchPasses) {
  Drive drive;
  drive.DriveOn(13, 0.045, 4);  // two steps are less than a ninth, three are more
  EXPECT_THAT(drive.Frames(), ElementsAre(0, 2, 4, 6, 8, 10, 12));
}

TEST(FramesForDepthTest, AreKeyframesAloneWhereTheseFollowOneAnotherCloselyOrNothingMoves) {
  Drive slow;
  slow.DriveOn(13, 0.02, 4);
  EXPECT_THAT(slow.Frames(), ElementsAre(0, 4, 8, 12));
  Drive still;
  still.DriveOn(17, 0.0, 4);
  EXPECT_THAT(still.Frames(), ElementsAre(0, 4, 8, 12, 16));
}

TEST(FramesForDepthTest, EndWithTheLastFrame) {
  Drive drive;
  drive.DriveOn(12, 0.02, 4);
  EXPECT_THAT(drive.Frames(), ElementsAre(0, 4, 8, 11));
}

TEST(FramesForDepthTest, AreNoneThatCannotBeReadOrWhosePoseTheMapWouldShow) {
  Drive drive;
  drive.DriveOn(13, 0.2, 4);
  drive.unreadable = {1, 8};
  drive.trajectory[2].source = PoseSource::kPredicted;
  for (int i = 4; i < 13; ++i) drive.trajectory[i].sigmas.setConstant(0.1);
  drive.trajectory[5].sigmas[1] = std::hypot(0.1, 0.011);  // beside the keyframe before it
  drive.trajectory[6].sigmas[1] = std::hypot(0.1, 0.009);
  drive.trajectory[7].sigmas[4] = std::hypot(0.1, 0.0055);  // 2 m away 11 mm
  drive.trajectory[9].sigmas[0] = std::numeric_limits<double>::quiet_NaN();
  drive.trajectory[10].source = PoseSource::kOdometry;
  drive.trajectory[12].source = PoseSource::kOdometry;  // a keyframe
  drive.trajectory[12].sigmas[2] = std::hypot(0.1, 0.02);
  EXPECT_THAT(drive.Frames(), ElementsAre(0, 3, 4, 6, 10, 11));
}

TEST(FramesForDepthTest, AreAllWhereHardlyAnyIsAKeyframe) {
  Drive drive;
  drive.DriveOn(8, 0.01, 4);
  EXPECT_THAT(drive.Frames(), ElementsAreArray({0, 1, 2, 3, 4, 5, 6, 7}));
}

}  // namespace
}  // namespace rigmap
