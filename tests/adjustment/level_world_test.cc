#include "adjustment/level_world.h"

#include <gtest/gtest.h>

#include "tests/adjustment/rover_bundle.h"

namespace rigmap {
namespace {

// A rover on level ground whose poses and points are given in a gauge of their own.
class LevelWorldTest : public testing::Test {
 protected:
  void Make(double relief_m) {
    rover_ =
        MakeSyntheticRover({.frames = 6, .points_per_m2 = 3.0, .relief_m = relief_m, .seed = 91});
    dataset_.rig = rover_.rig;
    for (const FrameFeatures& frame : rover_.frames) {
      dataset_.frames.push_back({.stamp_ns = frame.stamp_ns});
    }
    gauge_from_rover_ = random_.Motion(50.0);
  }

  // An inclinometer that is mounted at some angle and feels gravity only.
  void AddInclinometer() {
    dataset_.rig.imu_from_left = random_.Motion(1.0);
    for (std::size_t i = 0; i < rover_.frames.size(); ++i) {
      const Eigen::Vector3d up_in_left =
          rover_.world_from_left[i].rotation.conjugate() * Eigen::Vector3d::UnitZ();
      dataset_.inclinometer.push_back(
          {rover_.frames[i].stamp_ns, dataset_.rig.imu_from_left->rotation * (9.81 * up_in_left)});
    }
  }

  MaybePoses Poses() const {
    MaybePoses poses;
    for (const Rigid3& pose : rover_.world_from_left) poses.push_back(gauge_from_rover_ * pose);
    return poses;
  }

  std::vector<Eigen::Vector3d> Points() const {
    std::vector<Eigen::Vector3d> points;
    for (const Eigen::Vector3d& x : rover_.points) points.push_back(gauge_from_rover_ * x);
    return points;
  }

  // The rover's own world is what the result should be.
  void ExpectLevel(const LevelledWorld& world, double tolerance_rad) const {
    const Rigid3 off = world.world_from_gauge * gauge_from_rover_;
    EXPECT_LT(AngleOf(off.rotation), tolerance_rad);
    EXPECT_LT(off.translation.norm(), 1e-9);  // m
  }

  SyntheticRover rover_;
  Dataset dataset_;
  Rigid3 gauge_from_rover_;
  SeededRandom random_;
};

TEST_F(LevelWorldTest, TheInclinometerTellsUp) {
  Make(0.5);
  AddInclinometer();
  const LevelledWorld world = LevelWorld(Poses(), {}, dataset_);
  EXPECT_EQ(world.up_source, WorldUp::kImu);
  ExpectLevel(world, 1e-7);
}

TEST_F(LevelWorldTest, ElseTheGroundWhateverTheGauge) {
  Make(0.03);
  for (int trial = 0; trial < 5; ++trial) {
    gauge_from_rover_ = random_.Motion(500.0);
    const LevelledWorld world = LevelWorld(Poses(), Points(), dataset_);
    EXPECT_EQ(world.up_source, WorldUp::kGround);
    ExpectLevel(world, 1.0 * kDegree);
  }
}

TEST_F(LevelWorldTest, ElseTheFirstCamera) {
  Make(0.0);
  const LevelledWorld world = LevelWorld(Poses(), {}, dataset_);
  EXPECT_EQ(world.up_source, WorldUp::kCamera);
  const Rigid3 world_from_left = world.world_from_gauge * *Poses()[0];
  EXPECT_LT(
      (world_from_left.rotation * -Eigen::Vector3d::UnitY() - Eigen::Vector3d::UnitZ()).norm(),
      1e-9);
  EXPECT_LT((world_from_left.rotation * Eigen::Vector3d::UnitZ() - Eigen::Vector3d::UnitX()).norm(),
            1e-9);
}

TEST_F(LevelWorldTest, PointsWithoutAPlaneAreNoGround) {
  Make(0.0);
  std::vector<Eigen::Vector3d> cloud;
  for (int i = 0; i < 500; ++i) cloud.push_back(random_.Vector(5.0));
  EXPECT_EQ(LevelWorld(Poses(), cloud, dataset_).up_source, WorldUp::kCamera);
}

TEST_F(LevelWorldTest, TheOriginIsTheFirstFrameWithAPose) {
  Make(0.5);
  AddInclinometer();
  MaybePoses poses = Poses();
  poses[0].reset();
  poses[1].reset();
  const LevelledWorld world = LevelWorld(poses, {}, dataset_);
  const Rigid3 first = world.world_from_gauge * *poses[2];
  EXPECT_LT(first.translation.norm(), 1e-9);  // m
  const Eigen::Vector3d forward = first.rotation * Eigen::Vector3d::UnitZ();
  EXPECT_NEAR(forward.y(), 0.0, 1e-9);
  EXPECT_GT(forward.x(), 0.0);
  EXPECT_NEAR(std::asin(-forward.z()), 18.0 * kDegree, 1e-7);  // the camera's tilt
}

}  // namespace
}  // namespace rigmap
