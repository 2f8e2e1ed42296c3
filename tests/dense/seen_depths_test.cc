#include "dense/seen_depths.h"

#include <gtest/gtest.h>

namespace rigmap {
namespace {

StereoRig RigOf(double focal_px, double baseline_m) {
  StereoRig rig;
  rig.left.camera = {1000, 800, focal_px, focal_px, 500.0, 400.0};
  rig.right = rig.left;
  rig.right_from_left.translation = {-baseline_m, 0.0, 0.0};
  return rig;
}

// One point at each centimetre.
std::vector<std::vector<Eigen::Vector3d>> Points(double first_m, int count) {
  std::vector<std::vector<Eigen::Vector3d>> points(2);
  for (int i = 0; i < count; ++i) points[i % 2].push_back({0.1, 0.2, first_m + 0.01 * i});
  return points;
}

TEST(DepthsSeen, FollowFromSparsePointsAndFromWhatFramesSay) {
  const SeenDepths seen = DepthsSeen(RigOf(840.0, 0.12), Points(1.0, 2000), {1.5F, 9.0F, 1.25F});
  EXPECT_DOUBLE_EQ(seen.nearest_m, 0.5);
  EXPECT_DOUBLE_EQ(seen.near_m, 1.5);
}

TEST(DepthsSeen, AreNoNearerThanWhatBothImagesShow) {
  EXPECT_DOUBLE_EQ(DepthsSeen(RigOf(1000.0, 0.5), Points(0.2, 2000), {}).nearest_m, 1.0);
  const SeenDepths unseen = DepthsSeen(RigOf(1000.0, 0.5), Points(3.0, 50), {});
  EXPECT_DOUBLE_EQ(unseen.nearest_m, 1.0);
  EXPECT_DOUBLE_EQ(unseen.near_m, 10.0);
}

TEST(VoxelFor, IsACentimetreForTheRoverAndMoreForACar) {
  EXPECT_DOUBLE_EQ(VoxelFor(RigOf(840.0, 0.12), {0.7, 1.55}), 0.01);
  EXPECT_DOUBLE_EQ(VoxelFor(RigOf(719.0, 0.537), {2.0, 7.2}), 0.03);
  // Where the baseline is long, a pixel's width: 3 m / 1000.
  EXPECT_DOUBLE_EQ(VoxelFor(RigOf(1000.0, 1.0), {1.0, 3.0}), 0.003);
  EXPECT_DOUBLE_EQ(VoxelFor(RigOf(1000.0, 1.0), {1.0, 3.1}), 0.01);
  EXPECT_DOUBLE_EQ(VoxelFor(RigOf(1000.0, 1.0), {1.0, 1.0}), 0.001);
}

}  // namespace
}  // namespace rigmap
