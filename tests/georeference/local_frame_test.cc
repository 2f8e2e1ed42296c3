#include "georeference/local_frame.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/error.h"
#include "geographiclib_tools.h"
#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

const Geodetic kBeach{52.2141, 4.4004, 4.08};
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Geodetic RandomPosition(SeededRandom& random) {
  return {random.Uniform(-89.0, 89.0), random.Uniform(-180.0, 180.0),
          random.Uniform(-50.0, 3000.0)};
}

TEST(LocalFrame, OriginIsZero) {
  EXPECT_LT(LocalFrame(kBeach).ToEnu(kBeach).norm(), 1e-8);  // m
}

TEST(LocalFrame, ToGeodeticInvertsToEnu) {
  SeededRandom random;
  for (int i = 0; i < 200; ++i) {
    const LocalFrame frame(RandomPosition(random));
    const Eigen::Vector3d enu = random.Vector(5000.0);
    EXPECT_LT((frame.ToEnu(frame.ToGeodetic(enu)) - enu).norm(), 1e-7);  // m
  }
}

TEST(LocalFrame, AxesPointEastNorthAndUp) {
  SeededRandom random;
  for (int i = 0; i < 50; ++i) {
    const Geodetic origin = RandomPosition(random);
    const LocalFrame frame(origin);
    Geodetic higher = origin, farther_north = origin, farther_east = origin;
    higher.altitude_m += 10.0;
    farther_north.latitude_deg += 1e-5;
    farther_east.longitude_deg += 1e-5;
    EXPECT_LT((frame.ToEnu(higher) - Eigen::Vector3d(0.0, 0.0, 10.0)).norm(), 1e-7);  // m
    const Eigen::Vector3d north = frame.ToEnu(farther_north).normalized();
    const Eigen::Vector3d east = frame.ToEnu(farther_east).normalized();
    EXPECT_GT(north.y(), 1.0 - 1e-9);
    EXPECT_GT(east.x(), 1.0 - 1e-9);
  }
}

// On a sphere of the mean radius a place d away lies d^2 / 2R below the plane.
TEST(LocalFrame, SeaFallsAwayFromThePlane) {
  const LocalFrame frame(kBeach);
  Geodetic position = frame.ToGeodetic({1000.0, 0.0, 0.0});
  position.altitude_m = kBeach.altitude_m;
  EXPECT_NEAR(frame.ToEnu(position).z(), -1000.0 * 1000.0 / (2.0 * 6.39e6), 1e-3);  // m
}

TEST(LocalFrame, DistancesDoNotDependOnTheOrigin) {
  SeededRandom random;
  const LocalFrame here(kBeach), there(Geodetic{52.22, 4.39, 10.0});
  for (int i = 0; i < 50; ++i) {
    const Geodetic a = here.ToGeodetic(random.Vector(500.0));
    const Geodetic b = here.ToGeodetic(random.Vector(500.0));
    EXPECT_NEAR((here.ToEnu(a) - here.ToEnu(b)).norm(), (there.ToEnu(a) - there.ToEnu(b)).norm(),
                1e-7);  // m
  }
}

TEST(LocalFrame, RefusesWhatIsNoPosition) {
  EXPECT_THROW(LocalFrame(Geodetic{90.1, 0.0, 0.0}), DataError);
  EXPECT_THROW(LocalFrame(Geodetic{kNan, 0.0, 0.0}), DataError);
  const LocalFrame frame(kBeach);
  EXPECT_THROW(frame.ToEnu({-91.0, 4.0, 0.0}), DataError);
  EXPECT_THROW(frame.ToEnu({52.0, std::numeric_limits<double>::infinity(), 0.0}), DataError);
  EXPECT_THROW(frame.ToEnu({52.0, 4.0, kNan}), DataError);
  EXPECT_THROW(frame.ToGeodetic({0.0, kNan, 0.0}), DataError);
  EXPECT_NO_THROW(frame.ToEnu({90.0, 4.0, 0.0}));
}

TEST(LocalFrame, AgreesWithCartConvert) {
  if (!IsInstalled("CartConvert")) GTEST_SKIP() << "CartConvert is not installed";
  SeededRandom random;
  for (int i = 0; i < 10; ++i) {
    const LocalFrame frame(kBeach);
    const Geodetic position = frame.ToGeodetic(random.Vector(i < 5 ? 300.0 : 50'000.0));
    const auto expected = NumbersPrintedBy(
        fmt::format("echo '{:.15f} {:.15f} {:.12f}' | CartConvert -l {} {} {} -p 9",
                    position.latitude_deg, position.longitude_deg, position.altitude_m,
                    kBeach.latitude_deg, kBeach.longitude_deg, kBeach.altitude_m));
    ASSERT_EQ(expected.size(), 3U);
    const Eigen::Vector3d enu = frame.ToEnu(position);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(enu[axis], expected[static_cast<std::size_t>(axis)], 1e-6);  // m
    }
  }
}

}  // namespace
}  // namespace rigmap
