#include "trajectory/starting_poses.h"

#include <gtest/gtest.h>

#include "tests/support/seeded_random.h"
#include "tests/trajectory/odometric_part.h"

namespace rigmap {
namespace {

TEST(StartingPoses, AreMappedOrHangOnTheirReference) {
  Part part(4);
  for (const int keyframe : {0, 1, 3}) part.odometry[keyframe].keyframe = true;
  SeededRandom random;
  std::vector<std::optional<Rigid3>> mapped(4);
  mapped[1] = random.Motion(1.0);
  const auto starting = StartingPoses(part.odometry, mapped);
  ExpectSame(*starting[0], part.odometry[0].world_from_left);
  ExpectSame(*starting[1], *mapped[1]);
  ExpectSame(*starting[2], *mapped[1] * part.Step(1, 2));
  ExpectSame(*starting[3], *mapped[1] * part.Step(1, 3));
}

TEST(StartingPoses, AreTheOdometrysWhereNothingWasMapped) {
  const Part part(3);
  const auto starting = StartingPoses(part.odometry, {});
  for (int i = 0; i < 3; ++i) ExpectSame(*starting[i], part.odometry[i].world_from_left);
}

TEST(StartingPoses, AreNotGivenToFramesWithNothingToAdjust) {
  Part part(5);
  part.odometry[1].stands_still = true;
  part.odometry[2].source = PoseSource::kPredicted;
  part.odometry[3].source = PoseSource::kPredicted;
  part.odometry[3].keyframe = true;
  const auto starting = StartingPoses(part.odometry, {});
  EXPECT_TRUE(starting[0]);
  EXPECT_FALSE(starting[1]);
  EXPECT_FALSE(starting[2]);
  EXPECT_TRUE(starting[3]);
  EXPECT_TRUE(starting[4]);
}

// Frames before the first that shows enough hang on it, backwards: it is the start of the world.
TEST(AssembledTrajectory, BeginsAtTheFirstPosedFrame) {
  Part part(6);
  const Odometry truth = part.odometry;
  for (int i : {0, 1}) {
    part.odometry[i].source = PoseSource::kPredicted;
    part.odometry[i].reference = i + 1;
    part.odometry[i].step_covariance = Diagonal(kStepSigma_m, kStepSigma_rad);
  }
  part.odometry[2].reference = 2;
  part.odometry[2].step_covariance.setZero();
  part.odometry[2].keyframe = true;
  EXPECT_EQ(FirstPosedFrame(part.odometry), 2);
  part.adjustment.world_from_left[0].reset();
  SeededRandom random;
  const Rigid3 moved = random.Motion(3.0);
  part.adjustment.world_from_left[2] = moved;
  const Trajectory trajectory = part.Assemble();
  for (int i = 0; i < 6; ++i) {
    ExpectSame(trajectory[i].world_from_left, moved * part.Step(2, i));
  }
  EXPECT_EQ(trajectory[2].sigmas, Vector6d::Zero());
  // As far before it as behind it: as unsure.
  EXPECT_GT(trajectory[0].sigmas.head<3>().minCoeff(), kStepSigma_m);
  for (int i : {0, 1}) {
    EXPECT_NEAR(trajectory[i].sigmas.tail<3>().norm(), trajectory[4 - i].sigmas.tail<3>().norm(),
                1e-6);
  }
  const auto starting = StartingPoses(part.odometry, {});
  EXPECT_FALSE(starting[0]);
  EXPECT_FALSE(starting[1]);
  EXPECT_TRUE(starting[2]);
}

}  // namespace
}  // namespace rigmap
