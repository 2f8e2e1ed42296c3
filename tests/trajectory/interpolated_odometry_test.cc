#include "trajectory/interpolated_odometry.h"

#include <gtest/gtest.h>

#include "trajectory/assemble_trajectory.h"
#include "trajectory/starting_poses.h"

namespace rigmap {
namespace {

std::optional<Rigid3> At(double x) { return Rigid3{Eigen::Quaterniond::Identity(), {x, 0, 0}}; }

TEST(InterpolatedOdometry, PutsUnknownFramesBetweenTheirNeighboursByTime) {
  const std::vector<StampNs> stamps{0, 10, 20, 50, 60, 70};
  const std::vector<std::optional<Rigid3>> poses{{}, At(1.0), {}, At(5.0), At(5.5), {}};
  const Odometry odometry = InterpolatedOdometry(stamps, poses);
  ASSERT_EQ(odometry.size(), 6U);
  EXPECT_EQ(FirstPosedFrame(odometry), 1);
  const std::vector<double> expected{1.0, 1.0, 2.0, 5.0, 5.5, 5.5};
  Adjustment known;
  known.world_from_left = poses;
  known.datum_frames.assign(poses.size(), 1);
  const Trajectory trajectory = AssembleTrajectory(odometry, known, Rigid3());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(odometry[i].world_from_left.translation.x(), expected[i], 1e-12) << i;
    EXPECT_NEAR(trajectory[i].world_from_left.translation.x(), expected[i], 1e-12) << i;
    EXPECT_EQ(trajectory[i].source, poses[i] ? PoseSource::kAdjusted : PoseSource::kPredicted);
    EXPECT_EQ(trajectory[i].sigmas.allFinite(), i == 1) << i;  // nobody knows how good they are
  }
}

}  // namespace
}  // namespace rigmap
