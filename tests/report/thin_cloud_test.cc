#include "report/thin_cloud.h"

#include <gmock/gmock.h>

#include "tests/report/sample_result.h"

namespace rigmap {
namespace {

TEST(ThinCloudTest, KeepsAllOfASmallMap) {
  const TemporaryFolder folder;
  const PointCloud plane = SamplePlane();
  WriteSamplePly(folder.Path() / "dense.ply", plane);
  const ThinCloud cloud = ReadThinCloud(folder.Path() / "dense.ply", 1'000'000);
  EXPECT_EQ(cloud.points.size(), plane.size());
  EXPECT_EQ(cloud.count_in_map, plane.size());
  EXPECT_FLOAT_EQ(static_cast<float>(cloud.finest_m), 0.01F);
  EXPECT_FLOAT_EQ(static_cast<float>(cloud.median_sigma_m.value()), 0.002F);
  EXPECT_EQ(cloud.median_observations, 5.0);
  EXPECT_NEAR(cloud.area_m2, 8.0, 0.2);
  EXPECT_TRUE(cloud.rocks.has_value());
}

TEST(ThinCloudTest, ThinsALargeMapEvenly) {
  const TemporaryFolder folder;
  const PointCloud plane = SamplePlane();
  WriteSamplePly(folder.Path() / "dense.ply", plane);
  const ThinCloud cloud = ReadThinCloud(folder.Path() / "dense.ply", 1000);
  EXPECT_NEAR(static_cast<double>(cloud.points.size()), 1000.0, 1.0);
  EXPECT_EQ(cloud.count_in_map, plane.size());
  int left = 0;
  for (const SurfacePoint& point : cloud.points) left += point.x_in_world.x() < 1.0F ? 1 : 0;
  EXPECT_NEAR(left, 500, 30);
}

TEST(ThinCloudTest, CoarsePointsAtTheStartMakeNoCoarseMap) {
  const TemporaryFolder folder;
  const PointCloud plane = SamplePlane();
  PointCloud cloud;
  for (int i = 0; i < 20000; ++i) {  // some blocks of reading
    SurfacePoint far = plane.front();
    far.x_in_world.x() = -50.0F - 0.01F * static_cast<float>(i);
    far.grain_m = 0.08F;
    cloud.push_back(far);
  }
  cloud.insert(cloud.end(), plane.begin(), plane.end());
  WriteSamplePly(folder.Path() / "dense.ply", cloud);
  EXPECT_TRUE(ReadThinCloud(folder.Path() / "dense.ply", 1000).rocks.has_value());
}

TEST(ThinCloudTest, TellsOfNoRocksInACoarseMap) {
  const TemporaryFolder folder;
  PointCloud plane = SamplePlane();
  for (SurfacePoint& point : plane) point.grain_m = 0.03F;
  WriteSamplePly(folder.Path() / "dense.ply", plane);
  EXPECT_FALSE(ReadThinCloud(folder.Path() / "dense.ply", 1000).rocks.has_value());
}

}  // namespace
}  // namespace rigmap
