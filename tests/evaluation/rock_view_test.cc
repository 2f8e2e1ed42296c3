#include "evaluation/internal/rock_view.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

std::vector<TumPose> DriveAlongX(double from_m, double to_m) {
  std::vector<TumPose> poses;
  for (double x_m = from_m; x_m <= to_m; x_m += 0.1) {
    poses.push_back({.world_from_body = RoverPose(x_m, 0.0, 0.0)});
  }
  return poses;
}

// A rock two metres beside the path is seen from before it; the nearest pose looks past it.
TEST(ViewAxes, LookFromWhereARockBesideThePathIsSeen) {
  const std::vector<Eigen::Vector3d> rock{{5.0, 2.0, -0.8}};
  const Eigen::Matrix3d axes = ViewAxes(rock, DriveAlongX(0.0, 10.0));
  EXPECT_GT(axes(0, 0), 0.75);  // forwards
  EXPECT_GT(axes(0, 1), 0.4);   // and to the left
  EXPECT_LT((axes * axes.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  EXPECT_EQ(axes.row(2).transpose(), Eigen::Vector3d::UnitZ());
  EXPECT_NEAR(axes.determinant(), 1.0, 1e-12);
}

TEST(ViewAxes, LookForwardsAtARockAhead) {
  const std::vector<Eigen::Vector3d> rock{{4.0, 0.2, -0.8}, {4.2, -0.2, -0.6}};
  const Eigen::Matrix3d axes = ViewAxes(rock, DriveAlongX(0.0, 3.0));
  EXPECT_NEAR(axes(0, 0), 1.0, 1e-9);
}

// Never in view: from the nearest poses then.
TEST(ViewAxes, LookFromTheNearestPosesWhereNoneSeesTheRock) {
  const std::vector<Eigen::Vector3d> rock{{-1.0, 1.0, -0.8}};
  const Eigen::Matrix3d axes = ViewAxes(rock, DriveAlongX(0.0, 10.0));
  EXPECT_LT(axes(0, 0), -0.7);
  EXPECT_GT(axes(0, 1), 0.4);
}

}  // namespace
}  // namespace rigmap
