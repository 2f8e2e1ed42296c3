#include "export/trajectory_csv.h"

#include <gtest/gtest.h>

namespace rigmap {
namespace {

TEST(TrajectoryCsv, WritesAHeaderAndOneLinePerPose) {
  Trajectory trajectory(2);
  trajectory[0].stamp_ns = 1448551416619000123;
  trajectory[0].source = PoseSource::kAdjusted;
  trajectory[0].keyframe = true;
  trajectory[1].stamp_ns = 1448551417019000123;
  trajectory[1].world_from_left = {Eigen::Quaterniond(0.5, 0.5, -0.5, 0.5), {1.0, -2.5, 0.125}};
  trajectory[1].sigmas << 0.01, 0.02, 0.03, 0.001, 1.23456789e-7, 0.0;
  trajectory[1].source = PoseSource::kOdometry;
  EXPECT_EQ(WriteTrajectoryCsv(trajectory),
            "stamp_ns,tx,ty,tz,qx,qy,qz,qw,sx,sy,sz,srx,sry,srz,source,keyframe\n"
            "1448551416619000123,0.000000000,0.000000000,0.000000000,0.000000000000,"
            "0.000000000000,0.000000000000,1.000000000000,0,0,0,0,0,0,adjusted,1\n"
            "1448551417019000123,1.000000000,-2.500000000,0.125000000,0.500000000000,"
            "-0.500000000000,0.500000000000,0.500000000000,0.01,0.02,0.03,0.001,1.23457e-07,0,"
            "odometry,0\n");
}

TEST(TrajectoryCsv, OfNoPosesIsItsHeader) {
  EXPECT_EQ(WriteTrajectoryCsv({}),
            "stamp_ns,tx,ty,tz,qx,qy,qz,qw,sx,sy,sz,srx,sry,srz,source,keyframe\n");
}

}  // namespace
}  // namespace rigmap
