#include "georeference/earth_frame.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

EarthFrame RandomFrame(SeededRandom& random) {
  EarthFrame frame;
  frame.origin = {random.Uniform(-79.0, 83.0), random.Uniform(-180.0, 180.0),
                  random.Uniform(-50.0, 4000.0)};
  frame.angle_rad = random.Uniform(-3.0, 3.0);
  frame.translation = random.Vector(30.0);
  frame.zone = UtmZoneOf(frame.origin);
  return frame;
}

TEST(EarthMap, PointsLieAsFarFromTheOriginAsTheFrameSays) {
  SeededRandom random;
  for (int i = 0; i < 100; ++i) {
    const EarthFrame frame = RandomFrame(random);
    const Eigen::Vector3d x_in_world = random.Vector(100.0);
    const Eigen::Vector3d enu =
        LocalFrame(frame.origin).ToEnu(EarthMap(frame).ToGeodetic(x_in_world));
    EXPECT_LT((enu - frame.EnuFromWorld(x_in_world)).norm(), 1e-7);  // m
    EXPECT_NEAR((enu - frame.translation).norm(), x_in_world.norm(), 1e-7);
  }
}

// What rasters and clouds use instead of the exact conversion.
TEST(GridFrame, IsAsNearToTheExactConversionAsItSays) {
  SeededRandom random;
  for (int i = 0; i < 200; ++i) {
    const EarthMap earth(RandomFrame(random));
    const GridFrame grid = earth.GridAround(Eigen::Vector2d::Zero());
    EXPECT_EQ(grid.epsg, earth.frame().zone.Epsg());
    for (const double reach_m : {1.0, 100.0, 1000.0}) {
      Eigen::Vector3d x_in_world = random.Vector(reach_m / std::sqrt(2.0));
      x_in_world.z() = random.Uniform(-2.0, 2.0);
      const Eigen::Vector3d off = grid.GridFromWorld(x_in_world) - earth.ToGrid(x_in_world);
      // 2 m of height, up to 30 m and the reach from where up is the plane's.
      const double lean_m = 2.0 * (30.0 * std::sqrt(2.0) + reach_m) / 6.3e6;
      EXPECT_LT(off.head<2>().norm(), 4.5e-9 * reach_m * reach_m + lean_m);
      EXPECT_LT(std::abs(off.z()), 1e-3 * reach_m * reach_m / 1e6 + 1e-6);
    }
  }
}

TEST(GridFrame, TurnsAsTheGridDoes) {
  SeededRandom random;
  const EarthMap earth(RandomFrame(random));
  const Eigen::Vector3d from(3.0, 4.0, 0.0), to(3.5, 4.0, 0.0);
  const Eigen::Vector3d step = earth.ToGrid(to) - earth.ToGrid(from);
  EXPECT_NEAR(
      std::remainder(std::atan2(step.y(), step.x()) - earth.GridAngleAt({3.0, 4.0}), 6.28318530718),
      0.0, 1e-7);
}

}  // namespace
}  // namespace rigmap
