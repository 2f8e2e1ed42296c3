#include "dataset/internal/gnss_file.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cstdlib>
#include <tuple>

#include "core/error.h"
#include "georeference/local_frame.h"
#include "georeference/utm_grid.h"
#include "tests/dataset/sample_data.h"
#include "tests/support/message_of.h"
#include "tests/support/seeded_random.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

constexpr const char* kRows =
    "2015_11_26_12_53_37_5 RTK_FIXED 52.2141543493333 4.40039856933333 6.246 0.005 0.004 0.009\n"
    "\r\n"
    "2015_11_26_12_53_34_617 RTK_FLOAT 52.2141543786667 4.4003985435 6.242 0.2 0.1 0.4\r\n";

double Distance_m(const GnssFix& a, const GnssFix& b) {
  return LocalFrame({a.latitude_deg, a.longitude_deg, a.altitude_m})
      .ToEnu({b.latitude_deg, b.longitude_deg, b.altitude_m})
      .norm();
}

TEST(GnssFile, ReadsRowsInOrderOfTime) {
  const TemporaryFolder folder;
  const GnssReading reading = ReadGnssFile(folder.Write("gps.txt", kRows));
  EXPECT_TRUE(reading.remarks.empty());
  ASSERT_EQ(reading.fixes.size(), 2U);
  const GnssFix &first = reading.fixes[0], &second = reading.fixes[1];
  EXPECT_EQ(first.stamp_ns, ParseKatwijkStamp("2015_11_26_12_53_34_617"));
  EXPECT_EQ(second.stamp_ns - first.stamp_ns, 2'388'000'000);  // _5 is 5 ms
  EXPECT_EQ(first.status, "RTK_FLOAT");
  EXPECT_EQ(second.status, kRtkFixed);
  EXPECT_EQ(second.latitude_deg, 52.2141543493333);
  EXPECT_EQ(second.longitude_deg, 4.40039856933333);
  EXPECT_EQ(second.altitude_m, 6.246);
  EXPECT_EQ(second.sigma_enu_m, Eigen::Vector3d(0.004, 0.005, 0.009));  // the file has north first
}

TEST(GnssFile, TakesAStatusInAnyCase) {
  const TemporaryFolder folder;
  const GnssReading reading =
      ReadGnssFile(folder.Write("gps.txt", Replaced(kRows, "RTK_FIXED", "rtk_Fixed")));
  ASSERT_EQ(reading.fixes.size(), 2U);
  EXPECT_EQ(reading.fixes[1].status, kRtkFixed);
}

TEST(GnssFile, CountsARepeatedFixOnce) {
  const TemporaryFolder folder;
  const GnssReading reading = ReadGnssFile(folder.Write("gps.txt", std::string(kRows) + kRows));
  EXPECT_EQ(reading.fixes.size(), 2U);
  EXPECT_THAT(reading.remarks,
              testing::ElementsAre(testing::HasSubstr("gps.txt: 2 of 4 rows repeat a stamp")));
}

// Degrees, eastings first and northings first mean the same places.
TEST(GnssFile, TakesDegreesAndMetresInEitherOrder) {
  SeededRandom random;
  const TemporaryFolder folder;
  std::string degrees, easting_first, northing_first;
  for (int i = 0; i < 10; ++i) {
    const Geodetic position{random.Uniform(52.1, 52.3), random.Uniform(4.3, 4.5), 6.0};
    const UtmPoint utm = ToUtm(kUtm31, position);
    const auto row = [&](double first, double second) {
      return fmt::format("2015_11_26_12_53_{}_0 RTK_FIXED {:.13f} {:.13f} 6.0 0.005 0.004 0.009\n",
                         10 + i, first, second);
    };
    degrees += row(position.latitude_deg, position.longitude_deg);
    easting_first += row(utm.easting_m, utm.northing_m);
    northing_first += row(utm.northing_m, utm.easting_m);
  }
  const auto expected = ReadGnssFile(folder.Write("gps-utm31.txt", degrees)).fixes;
  ASSERT_EQ(expected.size(), 10U);
  for (const std::string& text : {easting_first, northing_first}) {
    const auto fixes = ReadGnssFile(folder.Write("gps-utm31.txt", text)).fixes;
    ASSERT_EQ(fixes.size(), expected.size());
    for (std::size_t i = 0; i < fixes.size(); ++i) {
      EXPECT_EQ(fixes[i].stamp_ns, expected[i].stamp_ns);
      EXPECT_LT(Distance_m(fixes[i], expected[i]), 1e-6);
    }
  }
}

TEST(GnssFile, LeavesOutBadRowsAndSaysWhich) {
  const TemporaryFolder folder;
  const std::string good = std::string(kRows).substr(0, std::string(kRows).find('\n') + 1);
  std::string later = good;
  later.replace(later.find("_37_"), 4, "_38_");
  for (const std::string bad :
       {"2015_11_26_12_53_39_5 RTK_FIXED 52.2 4.4 6.2 0.005 0.004",
        "2015_11_26_12_53_39_5 RTK_FIXED 52.2 4.4 6.2 0.005 0.004 0.009 1",
        "2015_11_26_12_53_39 RTK_FIXED 52.2 4.4 6.2 0.005 0.004 0.009",
        "2015_11_26_12_53_39_5 RTK_FIXED 52.2 nan 6.2 0.005 0.004 0.009",
        "2015_11_26_12_53_39_5 RTK_FIXED 52.2 4.4 6.2 0.005 -0.004 0.009",
        "2015_11_26_12_53_39_5 NO_FIX 0.0 0.0 0.0 0.005 0.004 0.009",
        "2015_11_26_12_53_39_5 RTK_FIXED 595000 595001 6.2 0.005 0.004 0.009",
        "2015_11_26_12_53_39_5 RTK_FIXED 595000 5785000 6.2 0.005 0.004 0.009"}) {
    const GnssReading reading = ReadGnssFile(folder.Write("gps.txt", good + later + bad + "\n"));
    EXPECT_EQ(reading.fixes.size(), 2U) << bad;
    ASSERT_EQ(reading.remarks.size(), 1U) << bad;
    EXPECT_NE(reading.remarks[0].find("gps.txt:3: expected"), std::string::npos);
    EXPECT_NE(reading.remarks[0].find(bad), std::string::npos);
    EXPECT_NE(reading.remarks[0].find("1 of 3 rows"), std::string::npos);
  }
}

TEST(GnssFile, RowsWithoutAPositionSayNothingOfTheColumns) {
  const TemporaryFolder folder;
  std::string rows;
  for (int second = 10; second < 16; ++second) {
    rows += "2015_11_26_12_53_" + std::to_string(second) + "_5 NO_FIX 0.0 0.0 0.0 0 0 0\n";
  }
  rows += "2015_11_26_12_53_39_5 RTK_FIXED 595000 5785000 6.2 0.005 0.004 0.009\n";
  const GnssReading reading = ReadGnssFile(folder.Write("gps-utm31.txt", rows));
  ASSERT_EQ(reading.fixes.size(), 1U);
  EXPECT_NEAR(reading.fixes[0].latitude_deg, 52.2, 0.1);
  EXPECT_THAT(reading.remarks, testing::ElementsAre(testing::HasSubstr("6 of 7 rows left out")));
}

TEST(GnssFile, RefusesAFileWithoutAnyFix) {
  const TemporaryFolder folder;
  for (const std::string text : {"", "\n\n", "no fix today\n"}) {
    const auto path = folder.Write("gps.txt", text);
    const std::string message = MessageOf<DataError>([&] { ReadGnssFile(path); });
    EXPECT_NE(message.find("gps.txt:1: expected"), std::string::npos) << message;
  }
  EXPECT_THROW(ReadGnssFile(folder.Path() / "none.txt"), DataError);
}

TEST(GnssFile, PrefersDegreesAndNeedsNeither) {
  const TemporaryFolder folder;
  EXPECT_FALSE(ReadGnss(folder.Path()));
  folder.Write("gps-utm31.txt", kRows);
  EXPECT_EQ(ReadGnss(folder.Path())->fixes.size(), 2U);
  folder.Write("gps-latlong.txt", std::string(kRows).substr(0, std::string(kRows).find('\n')));
  EXPECT_EQ(ReadGnss(folder.Path())->fixes.size(), 1U);
}

// A desert in Chile, zone 19 south, and a quarry in California, zone 10.
TEST(GnssFile, TakesMetresOfTheZoneInItsName) {
  for (const auto& [position, name] :
       {std::pair(Geodetic{-23.02, -67.75, 2400.0}, "gps-utm19s.txt"),
        std::pair(Geodetic{37.9, -122.4, 12.0}, "gps-utm10.txt")}) {
    const TemporaryFolder folder;
    const UtmPoint utm = ToUtm(UtmZoneOf(position), position);
    folder.Write("gps-utm61.txt", "no zone");
    folder.Write(name, fmt::format("2015_11_26_12_53_39_5 RTK_FIXED {:.6f} {:.6f} {} 0.005 0.004 "
                                   "0.009\n",
                                   utm.easting_m, utm.northing_m, position.altitude_m));
    const auto reading = ReadGnss(folder.Path());
    ASSERT_TRUE(reading) << name;
    ASSERT_EQ(reading->fixes.size(), 1U);
    EXPECT_NEAR(reading->fixes[0].latitude_deg, position.latitude_deg, 1e-10);
    EXPECT_NEAR(reading->fixes[0].longitude_deg, position.longitude_deg, 1e-10);
  }
}

// Uganda and Palawan, where one order alone lies in the zone; Brunei, where both do.
TEST(GnssFile, TakesMetresNearTheEquator) {
  const auto row = [](int second, double first_m, double second_m) {
    return fmt::format("2015_11_26_12_53_{}_5 RTK_FIXED {:.6f} {:.6f} 12 0.005 0.004 0.009\n",
                       second, first_m, second_m);
  };
  for (const auto& [position, name, has_remark] :
       {std::tuple(Geodetic{0.35, 32.58, 12.0}, "gps-utm36.txt", false),
        std::tuple(Geodetic{7.7, 117.6, 12.0}, "gps-utm50.txt", false),
        std::tuple(Geodetic{4.9, 114.9, 12.0}, "gps-utm50.txt", true)}) {
    const UtmPoint utm = ToUtm(UtmZoneOf(position), position);
    for (const bool easting_first : {true, false}) {
      if (has_remark && !easting_first) continue;
      const TemporaryFolder folder;
      std::string rows;
      for (int i = 0; i < 5; ++i) {
        const double east = utm.easting_m + i, north = utm.northing_m + i;
        rows += easting_first ? row(10 + i, east, north) : row(10 + i, north, east);
      }
      rows += easting_first ? row(20, utm.easting_m, utm.northing_m + 3e5)
                            : row(20, utm.northing_m + 3e5, utm.easting_m);
      folder.Write(name, rows);
      const auto reading = ReadGnss(folder.Path());
      ASSERT_TRUE(reading) << name;
      ASSERT_EQ(reading->fixes.size(), 5U) << name << " " << easting_first;
      EXPECT_NEAR(reading->fixes[0].latitude_deg, position.latitude_deg, 1e-10);
      EXPECT_NEAR(reading->fixes[0].longitude_deg, position.longitude_deg, 1e-10);
      EXPECT_EQ(reading->remarks.size(), has_remark ? 2U : 1U);
    }
  }
}

TEST(GnssFile, ReadsARealExcerpt) {
  const char* data = std::getenv("RIGMAP_DATA");
  if (data == nullptr) GTEST_SKIP() << "RIGMAP_DATA is not set";
  const auto reading = ReadGnss(std::filesystem::path(data) / "katwijk-text");
  ASSERT_TRUE(reading);
  EXPECT_TRUE(reading->remarks.empty());
  EXPECT_GE(reading->fixes.size(), 100U);
  for (std::size_t i = 1; i < reading->fixes.size(); ++i) {
    const GnssFix &before = reading->fixes[i - 1], &fix = reading->fixes[i];
    EXPECT_EQ(fix.status, kRtkFixed);
    EXPECT_GT(fix.stamp_ns, before.stamp_ns);
    EXPECT_LT(fix.sigma_enu_m.maxCoeff(), 0.02);  // m
    const double seconds = 1e-9 * static_cast<double>(fix.stamp_ns - before.stamp_ns);
    EXPECT_LT(Distance_m(before, fix), 0.7 * seconds + 0.03);  // the rover's speed and some noise
  }
}

}  // namespace
}  // namespace rigmap
