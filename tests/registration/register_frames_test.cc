#include "registration/register_frames.h"

#include <gtest/gtest.h>

#include "tests/registration/relief.h"
#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

constexpr double kBox_m = 0.05, kStep_m = 0.15;
constexpr UnmeasuredMotion kUnmeasured{0.3, 0.1};

std::vector<Rigid3> Drive(int count) {
  std::vector<Rigid3> poses;
  for (int i = 0; i < count; ++i) poses.push_back(WorldFromLeft(kStep_m * i, 0.02 * i));
  return poses;
}

CloudSource CloudsOf(const std::vector<Rigid3>& poses, double relief_m, int empty = -1) {
  return [=](int frame) {
    if (frame == empty) return FrameCloud();
    return SeenFrom(poses[frame], relief_m, 0.003, static_cast<unsigned>(frame) + 1);
  };
}

// Measured, to a centimetre a step.
Odometry OdometryOf(const std::vector<Rigid3>& poses) {
  Odometry odometry;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    OdometryFrame frame{.stamp_ns = static_cast<StampNs>(i) * 1'000'000'000,
                        .world_from_left = poses[0].Inverse() * poses[i],
                        .source = PoseSource::kOdometry};
    frame.world_from_left.translation.x() += i % 2 == 0 ? 0.01 : 0.0;
    odometry.push_back(frame);
  }
  return odometry;
}

RegistrationOptions Improved() {
  RegistrationOptions options;
  options.way = RegistrationWay::kImproved;
  return options;
}

TEST(RegisterFrames, ChainsWhatTheSurfaceHolds) {
  const auto poses = Drive(10);
  const Registration found = RegisterFrames(CloudsOf(poses, 0.05), OdometryOf(poses), LocCamRig(),
                                            kBox_m, Improved(), kUnmeasured);
  ASSERT_EQ(found.motion.size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(found.motion[i].source, PoseSource::kOdometry) << i;
    EXPECT_TRUE(found.frames[i].held) << i;
    const Rigid3 expected = poses[0].Inverse() * poses[i];
    EXPECT_LT((found.motion[i].world_from_left.translation - expected.translation).norm(), 0.01)
        << i;
    if (i >= 2) {
      ASSERT_TRUE(found.frames[i].closure_m);
      EXPECT_LT(*found.frames[i].closure_m, 0.015);
    }
  }
  EXPECT_GT(found.motion.back().step_covariance.trace(), 0.0);
}

TEST(RegisterFrames, PredictsAFrameThatShowsNothingAndGoesOnBehindIt) {
  const auto poses = Drive(6);
  const Registration found = RegisterFrames(CloudsOf(poses, 0.05, 3), OdometryOf(poses),
                                            LocCamRig(), kBox_m, Improved(), kUnmeasured);
  EXPECT_EQ(found.motion[3].source, PoseSource::kPredicted);
  EXPECT_FALSE(found.frames[3].held);
  EXPECT_EQ(found.motion[4].source, PoseSource::kOdometry);
  const Rigid3 expected = poses[0].Inverse() * poses[5];
  EXPECT_LT((found.motion[5].world_from_left.translation - expected.translation).norm(), 0.01);
}

TEST(RegisterFrames, SaysWhatSlides) {
  const auto poses = Drive(6);
  for (const bool is_plain : {true, false}) {
    const Registration found =
        RegisterFrames(CloudsOf(poses, 0.0), OdometryOf(poses), LocCamRig(), kBox_m,
                       is_plain ? RegistrationOptions() : Improved(), kUnmeasured);
    int held = 0;
    for (std::size_t i = 1; i < poses.size(); ++i) {
      if (!found.frames[i].held) {
        // The plain way chains it all the same.
        EXPECT_EQ(found.motion[i].source,
                  is_plain ? PoseSource::kOdometry : PoseSource::kPredicted);
        EXPECT_GT(found.motion[i].step_covariance.trace(), 1e-4);
      } else {
        ++held;
      }
    }
    EXPECT_LE(held, 3);
  }
}

TEST(RegisterFrames, GivesTheSameTwice) {
  const auto poses = Drive(5);
  const auto run = [&] {
    return RegisterFrames(CloudsOf(poses, 0.05), OdometryOf(poses), LocCamRig(), kBox_m, {},
                          kUnmeasured);
  };
  const Registration a = run(), b = run();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(a.motion[i].world_from_left.translation, b.motion[i].world_from_left.translation);
  }
}

TEST(RegisterFrames, NoFrameThatShowsAnythingLeavesGuesses) {
  const auto poses = Drive(3);
  const auto nothing = [](int) { return FrameCloud(); };
  const Registration found =
      RegisterFrames(nothing, OdometryOf(poses), LocCamRig(), kBox_m, {}, kUnmeasured);
  for (const OdometryFrame& frame : found.motion) EXPECT_EQ(frame.source, PoseSource::kPredicted);
}

}  // namespace
}  // namespace rigmap
