#include "georeference/utm_grid.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "core/error.h"
#include "geographiclib_tools.h"
#include "georeference/local_frame.h"
#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
constexpr double kDegree = std::numbers::pi / 180.0;

Geodetic RandomPositionOfTheZone(SeededRandom& random) {
  return {random.Uniform(-80.0, 84.0), random.Uniform(0.0, 6.0), random.Uniform(-10.0, 100.0)};
}

TEST(UtmGrid, ZonesAreThoseOfMapsWithTheirEpsgNumbers) {
  EXPECT_EQ(UtmZoneOf({52.21, 4.40, 0.0}).Epsg(), 32631);   // Katwijk
  EXPECT_EQ(UtmZoneOf({75.4, -89.8, 0.0}).Epsg(), 32616);   // Devon Island
  EXPECT_EQ(UtmZoneOf({-24.0, -70.0, 0.0}).Epsg(), 32719);  // Atacama
  EXPECT_EQ(UtmZoneOf({60.4, 5.3, 0.0}).Name(), "32N");     // Bergen, widened
  EXPECT_EQ(UtmZoneOf({78.2, 15.6, 0.0}).Name(), "33N");    // Svalbard
  EXPECT_EQ(UtmZoneOf({0.0, 180.0, 0.0}).Name(), "1N");
  EXPECT_EQ(UtmZoneOf({-0.001, 179.9, 0.0}).Name(), "60S");
  EXPECT_FALSE(HasUtmZone({84.5, 0.0, 0.0}));
  EXPECT_THROW(UtmZoneOf({84.5, 0.0, 0.0}), DataError);
  EXPECT_THROW(UtmZoneOf({-80.5, 0.0, 0.0}), DataError);
}

TEST(UtmGrid, FromUtmInvertsToUtmInEveryZone) {
  SeededRandom random;
  for (int i = 0; i < 500; ++i) {
    const Geodetic position{random.Uniform(-80.0, 84.0), random.Uniform(-180.0, 180.0),
                            random.Uniform(-10.0, 100.0)};
    const UtmZone zone = UtmZoneOf(position);
    const UtmPoint point = ToUtm(zone, position);
    EXPECT_GT(point.easting_m, 100'000.0);
    EXPECT_LT(point.easting_m, 900'000.0);
    EXPECT_GE(point.northing_m, 0.0);
    const Geodetic back = FromUtm(zone, point.easting_m, point.northing_m, position.altitude_m);
    EXPECT_LT(LocalFrame(position).ToEnu(back).norm(), 1e-7);  // m
  }
}

TEST(UtmGrid, AgreesWithAnotherProgram) {
  if (!IsInstalled("GeoConvert")) GTEST_SKIP() << "GeoConvert is not installed";
  SeededRandom random;
  for (int i = 0; i < 10; ++i) {
    const Geodetic position{random.Uniform(-79.0, 83.0), random.Uniform(-180.0, 180.0), 0.0};
    // "31n 595704.1234 5785780.5": the zone is no number.
    const auto printed =
        NumbersPrintedBy(fmt::format("echo {:.12f} {:.12f} | GeoConvert -u -p 6",
                                     position.latitude_deg, position.longitude_deg));
    const UtmPoint point = ToUtm(UtmZoneOf(position), position);
    ASSERT_GE(printed.size(), 2U);
    EXPECT_NEAR(point.easting_m, printed[printed.size() - 2], 1e-5);
    EXPECT_NEAR(point.northing_m, printed.back(), 1e-5);
  }
}

TEST(UtmGrid, EpsgNumbersNameZonesAndBack) {
  for (const int epsg : {32601, 32631, 32660, 32701, 32719, 32760}) {
    ASSERT_TRUE(UtmZoneOfEpsg(epsg)) << epsg;
    EXPECT_EQ(UtmZoneOfEpsg(epsg)->Epsg(), epsg);
  }
  for (const int epsg : {0, 4326, 28992, 32600, 32661, 32700, 32761}) {
    EXPECT_FALSE(UtmZoneOfEpsg(epsg)) << epsg;
  }
}

TEST(UtmGrid, RefusesWhatLiesFarFromTheZone) {
  EXPECT_THROW(ToUtm({31, true}, {52.0, 40.0, 0.0}), DataError);
  EXPECT_THROW(FromUtm({31, true}, 1e8, 0.0, 0.0), DataError);
  EXPECT_NO_THROW(ToUtm({60, true}, {0.0, -179.0, 0.0}));  // two degrees across the antimeridian
}

TEST(Utm31, FromUtm31InvertsToUtm31) {
  SeededRandom random;
  for (int i = 0; i < 300; ++i) {
    const Geodetic position = RandomPositionOfTheZone(random);
    const UtmPoint point = ToUtm(kUtm31, position);
    const Geodetic back = FromUtm(kUtm31, point.easting_m, point.northing_m, position.altitude_m);
    EXPECT_LT(LocalFrame(position).ToEnu(back).norm(), 1e-7);  // m
  }
}

TEST(Utm31, CentralMeridianIsStraightAndShrunk) {
  for (double latitude_deg = -60.0; latitude_deg <= 80.0; latitude_deg += 20.0) {
    const UtmPoint point = ToUtm(kUtm31, {latitude_deg, 3.0, 0.0});
    EXPECT_NEAR(point.easting_m, 500'000.0, 1e-7);
    EXPECT_NEAR(point.convergence_rad, 0.0, 1e-12);
    EXPECT_NEAR(point.scale, 0.9996, 1e-12);
  }
  EXPECT_NEAR(ToUtm(kUtm31, {0.0, 3.0, 0.0}).northing_m, 0.0, 1e-7);
}

TEST(Utm31, IsMirroredAtTheCentralMeridianAndTheEquator) {
  SeededRandom random;
  for (int i = 0; i < 50; ++i) {
    const double latitude_deg = random.Uniform(0.0, 80.0), aside_deg = random.Uniform(0.0, 3.0);
    const UtmPoint east = ToUtm(kUtm31, {latitude_deg, 3.0 + aside_deg, 0.0});
    const UtmPoint west = ToUtm(kUtm31, {latitude_deg, 3.0 - aside_deg, 0.0});
    const UtmPoint south = ToUtm(kUtm31, {-latitude_deg, 3.0 + aside_deg, 0.0});
    EXPECT_NEAR(east.easting_m - 500'000.0, 500'000.0 - west.easting_m, 1e-6);
    EXPECT_NEAR(east.northing_m, west.northing_m, 1e-6);
    EXPECT_NEAR(east.convergence_rad, -west.convergence_rad, 1e-12);
    EXPECT_NEAR(east.northing_m, -south.northing_m, 1e-6);
  }
}

// The grid turns and scales a small step as the header says; compared with a step in the local
// frame, at the ellipsoid, where heights change nothing.
TEST(Utm31, ConvergenceAndScaleTellWhereAStepGoes) {
  SeededRandom random;
  for (int i = 0; i < 100; ++i) {
    Geodetic position = RandomPositionOfTheZone(random);
    position.altitude_m = 0.0;
    const UtmPoint from = ToUtm(kUtm31, position);
    const double east_m = random.Uniform(-1.0, 1.0), north_m = random.Uniform(-1.0, 1.0);
    const UtmPoint to = ToUtm(kUtm31, LocalFrame(position).ToGeodetic({east_m, north_m, 0.0}));
    const double cosine = std::cos(from.convergence_rad), sine = std::sin(from.convergence_rad);
    EXPECT_NEAR(to.easting_m - from.easting_m, from.scale * (east_m * cosine - north_m * sine),
                2e-5);  // m
    EXPECT_NEAR(to.northing_m - from.northing_m, from.scale * (east_m * sine + north_m * cosine),
                2e-5);  // m
  }
}

TEST(Utm31, ConvergenceNearKatwijkIsAboutLongitudeTimesSineOfLatitude) {
  EXPECT_NEAR(ToUtm(kUtm31, {52.2141, 4.4004, 0.0}).convergence_rad,
              1.4004 * kDegree * std::sin(52.2141 * kDegree), 1e-5);
}

TEST(Utm31, HeightAndFullTurnsChangeNothing) {
  const UtmPoint point = ToUtm(kUtm31, {52.2141, 4.4004, 0.0});
  const UtmPoint raised = ToUtm(kUtm31, {52.2141, 4.4004 - 360.0, 1000.0});
  EXPECT_NEAR(point.easting_m, raised.easting_m, 1e-6);
  EXPECT_NEAR(point.northing_m, raised.northing_m, 1e-6);
  EXPECT_EQ(FromUtm(kUtm31, point.easting_m, point.northing_m, 17.5).altitude_m, 17.5);
}

TEST(Utm31, RefusesWhatIsNotNear) {
  EXPECT_THROW(ToUtm(kUtm31, {90.5, 3.0, 0.0}), DataError);
  EXPECT_THROW(ToUtm(kUtm31, {52.0, 40.0, 0.0}), DataError);
  EXPECT_THROW(ToUtm(kUtm31, {52.0, kNoNumber, 0.0}), DataError);
  EXPECT_THROW(FromUtm(kUtm31, kNoNumber, 5.0e6, 0.0), DataError);
  EXPECT_THROW(FromUtm(kUtm31, 5.0e5, 2.0e7, 0.0), DataError);
  EXPECT_THROW(FromUtm(kUtm31, 9.0e6, 5.0e6, 0.0), DataError);
  EXPECT_THROW(FromUtm(kUtm31, 5.0e5, 5.0e6, kNoNumber), DataError);
}

TEST(Utm31, AgreesWithGeoConvert) {
  if (!IsInstalled("GeoConvert")) GTEST_SKIP() << "GeoConvert is not installed";
  SeededRandom random;
  for (int i = 0; i < 10; ++i) {
    const Geodetic position{random.Uniform(i < 5 ? 52.0 : 1.0, i < 5 ? 52.4 : 83.0),
                            random.Uniform(i < 5 ? 4.2 : 0.1, i < 5 ? 4.6 : 5.9), 0.0};
    const std::string ask = fmt::format("echo '{:.15f} {:.15f}' | GeoConvert -z 31n -p 9 ",
                                        position.latitude_deg, position.longitude_deg);
    const auto grid = NumbersPrintedBy(ask + "-u");
    const auto turn = NumbersPrintedBy(ask + "-c");
    ASSERT_EQ(grid.size(), 2U);
    ASSERT_EQ(turn.size(), 2U);
    const UtmPoint point = ToUtm(kUtm31, position);
    EXPECT_NEAR(point.easting_m, grid[0], 1e-6);   // m
    EXPECT_NEAR(point.northing_m, grid[1], 1e-6);  // m
    EXPECT_NEAR(point.convergence_rad, turn[0] * kDegree, 1e-12);
    EXPECT_NEAR(point.scale, turn[1], 1e-12);
  }
}

}  // namespace
}  // namespace rigmap
