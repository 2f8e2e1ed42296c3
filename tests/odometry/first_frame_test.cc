// With which frame the odometry begins.
#include <gtest/gtest.h>

#include <cmath>

#include "odometry/track_frames.h"
#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

constexpr double kNoise_px = 0.1;
constexpr double kMaxOffset_m = 0.02;  // of poses over a few keyframes, see track_frames_test.cc

Odometry TrackRover(const SyntheticRover& rover) {
  const auto features = [&](int frame) { return rover.frames[frame]; };
  return TrackFrames(static_cast<int>(rover.frames.size()), features, rover.rig, {});
}

// Frames that cannot carry others are no start: they come last, backwards from the one that can.
TEST(TrackFrames, StartsWithTheFirstFrameThatCanCarryOthers) {
  SyntheticRover rover = MakeSyntheticRover({.frames = 12, .pixel_sigma = kNoise_px});
  for (int frame : {0, 1, 2}) {
    rover.frames[frame] = FrameFeatures{.stamp_ns = rover.frames[frame].stamp_ns};
  }
  const Odometry odometry = TrackRover(rover);
  EXPECT_TRUE(odometry[3].keyframe);
  EXPECT_EQ(odometry[3].reference, 3);
  for (int i = 2; i >= 0; --i) {
    EXPECT_EQ(odometry[i].stamp_ns, rover.frames[i].stamp_ns);
    EXPECT_EQ(odometry[i].source, PoseSource::kPredicted);
    EXPECT_EQ(odometry[i].reference, i + 1);
    EXPECT_FALSE(odometry[i].keyframe);
    const Rigid3 first_from_this = rover.world_from_left[3].Inverse() * rover.world_from_left[i];
    const double sigma_m = std::sqrt(odometry[i].step_covariance(0, 0));
    EXPECT_GT(sigma_m, 0.01);
    EXPECT_LT((odometry[i].world_from_left.translation - first_from_this.translation).norm(),
              (3 - i) * sigma_m);
  }
  for (int i = 4; i < 12; ++i) {
    EXPECT_EQ(odometry[i].source, PoseSource::kOdometry);
    EXPECT_GE(odometry[i].reference, 3);
    const Rigid3 truth = rover.world_from_left[3].Inverse() * rover.world_from_left[i];
    EXPECT_LT((odometry[i].world_from_left.translation - truth.translation).norm(), kMaxOffset_m);
  }
}

// A frame with one eye has no stereo points to carry others, but others can carry it.
TEST(TrackFrames, PosesOneEyedFramesBeforeTheFirst) {
  SyntheticRover rover = MakeSyntheticRover({.frames = 8, .pixel_sigma = kNoise_px});
  for (int frame : {0, 1}) {
    for (Feature& feature : rover.frames[frame].features) feature.right.reset();
  }
  const Odometry odometry = TrackRover(rover);
  EXPECT_EQ(odometry[2].reference, 2);
  for (int i : {0, 1}) {
    EXPECT_EQ(odometry[i].source, PoseSource::kOdometry);
    EXPECT_EQ(odometry[i].reference, 2);
    EXPECT_FALSE(odometry[i].keyframe);
    const Rigid3 truth = rover.world_from_left[2].Inverse() * rover.world_from_left[i];
    EXPECT_LT((odometry[i].world_from_left.translation - truth.translation).norm(), kMaxOffset_m);
  }
}

}  // namespace
}  // namespace rigmap
