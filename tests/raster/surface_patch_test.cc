#include "raster/internal/surface_patch.h"

#include <gtest/gtest.h>

#include "tests/raster/synthetic_map.h"
#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

constexpr float kGrain_m = 0.08F;

SurfacePoint PointOfPlane(const Eigen::Vector3d& x, const Eigen::Vector3d& normal) {
  SurfacePoint point = MapPoint(x.x(), x.y(), x.z());
  point.normal = normal.cast<float>();
  point.grain_m = kGrain_m;
  return point;
}

TEST(SurfacePatch, LiesInThePlaneAndSpansTheCube) {
  SeededRandom random;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d normal = random.Noise(1.0).normalized();
    const Eigen::Vector3d x = random.Noise(2.0);
    const SurfacePatch patch = PatchOf(PointOfPlane(x, normal));
    int axis = 0;
    normal.cwiseAbs().maxCoeff(&axis);
    const Eigen::Vector3d middle = patch.corner + 0.5 * (patch.edges[0] + patch.edges[1]);
    for (const Eigen::Vector3d& corner :
         {patch.corner, Eigen::Vector3d(patch.corner + patch.edges[0]),
          Eigen::Vector3d(patch.corner + patch.edges[1]),
          Eigen::Vector3d(patch.corner + patch.edges[0] + patch.edges[1])}) {
      EXPECT_NEAR(normal.dot(corner - x), 0.0, 1e-6);  // m
      for (int k = 0; k < 3; ++k) {
        if (k == axis) continue;
        // At a multiple of the grain, in the cube that holds the point.
        const double cubes = corner(k) / kGrain_m;
        EXPECT_NEAR(cubes, std::round(cubes), 1e-4);
        EXPECT_LE(std::abs(middle(k) - x(k)), 0.5001 * kGrain_m);
      }
    }
  }
}

TEST(SurfacePatch, HasTheHeightOfItsPlaneWhereThatIsLevelEnough) {
  SeededRandom random;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d normal = (Eigen::Vector3d::UnitZ() + random.Noise(0.2)).normalized();
    const Eigen::Vector3d x = random.Noise(2.0);
    const SurfacePoint point = PointOfPlane(x, normal);
    const Eigen::Vector2d beside = x.head<2>() + Eigen::Vector2d(0.02, -0.03);
    Eigen::Vector3d on_plane;
    on_plane << beside, HeightAt(point, beside);
    if (normal.z() < 0.75) continue;
    EXPECT_NEAR(normal.dot(on_plane - x), 0.0, 1e-6);  // m
  }
  const SurfacePoint wall = PointOfPlane({0.0, 0.0, 1.0}, {0.8, 0.0, 0.6});
  EXPECT_EQ(HeightAt(wall, {0.03, 0.0}), 1.0);
}

TEST(SurfacePatch, IsDoubtfulAndLightWhereItIsCoarse) {
  SurfacePoint point = PointOfPlane({0.0, 0.0, 1.0}, Eigen::Vector3d::UnitZ());
  point.sigma_m = 0.05F;
  point.observations = 64;
  const CellSample coarse = SampleOf(point, 1.0, 0.01);
  EXPECT_FLOAT_EQ(coarse.weight, 1.0F);  // of 64 cells
  EXPECT_FLOAT_EQ(coarse.doubt_m, 0.1F);
  EXPECT_EQ(coarse.observations, 64.0F);
  point.grain_m = 0.01F;
  const CellSample fine = SampleOf(point, 1.0, 0.01);
  EXPECT_FLOAT_EQ(fine.weight, 64.0F);
  EXPECT_EQ(fine.doubt_m, 0.0F);
}

}  // namespace
}  // namespace rigmap
