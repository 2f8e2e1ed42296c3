#include "georeference/utm_grid.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "geographiclib_tools.h"
#include "georeference/local_frame.h"
#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

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

}  // namespace
}  // namespace rigmap
