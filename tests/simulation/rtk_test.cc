#include "simulation/internal/rtk.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

const SensorClock kRtkClock{ParseKatwijkStamp("2015_11_26_15_23_38_849"), 7};

double Ground(double east_m, double north_m) {
  return 0.05 * std::sin(east_m) + 0.03 * std::cos(0.8 * north_m);
}

class Rtk : public testing::Test {
 protected:
  std::vector<GnssFix> Fixes(const RtkFaults& faults) const {
    return SimulateRtk(motion_, mount_, local_, kRtkClock, faults);
  }
  Eigen::Vector3d EnuOf(const GnssFix& fix) const {
    return local_.ToEnu({fix.latitude_deg, fix.longitude_deg, fix.altitude_m});
  }
  // Measured minus true antenna, metres east, north, up.
  Eigen::Vector3d ErrorOf(const GnssFix& fix, double clock_offset_s) const {
    const double time_s = kRtkClock.TimeAt(fix.stamp_ns) - clock_offset_s;
    return EnuOf(fix) - motion_.WorldFromBody(time_s) * mount_.AntennaInBody();
  }

  RoverMotion motion_{MakeRoverPath({"traverse3", 1000, 0.2, 1.25, 1.2}), Ground};
  RoverMount mount_ = MountOf(StereoRig{});
  LocalFrame local_{Geodetic{52.2141, 4.4004, 4.08}};
};

TEST_F(Rtk, ErrorsHaveTheStatedSigmas) {
  for (const double clock_offset_s : {0.0, 0.37, -1.2}) {
    const auto fixes = Fixes({clock_offset_s, {}});
    ASSERT_GT(fixes.size(), 400U);
    Eigen::Vector3d squares = Eigen::Vector3d::Zero(), sum = Eigen::Vector3d::Zero();
    for (const GnssFix& fix : fixes) {
      EXPECT_EQ(fix.status, "RTK_FIXED");
      sum += ErrorOf(fix, clock_offset_s);
      squares += ErrorOf(fix, clock_offset_s).cwiseAbs2();
    }
    const auto count = static_cast<double>(fixes.size());
    const Eigen::Vector3d rms = (squares / count).cwiseSqrt();
    const Eigen::Vector3d expected(0.004, 0.005, 0.009);  // m
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(rms[axis], expected[axis], 0.15 * expected[axis]);
      EXPECT_LT(std::abs(sum[axis] / count), 0.25 * expected[axis]);
    }
  }
}

TEST_F(Rtk, ComesEveryThreeSecondsWhileTheSensorsRun) {
  const auto fixes = Fixes({});
  EXPECT_LT(kRtkClock.TimeAt(fixes.front().stamp_ns), 0.0);
  EXPECT_GT(kRtkClock.TimeAt(fixes.back().stamp_ns), motion_.path().duration_s() - 1.1);
  for (std::size_t i = 1; i < fixes.size(); ++i) {
    EXPECT_NEAR(1e-9 * static_cast<double>(fixes[i].stamp_ns - fixes[i - 1].stamp_ns), 3.0, 0.012);
  }
}

TEST_F(Rtk, OutageDegradesThenHoldsItsTongue) {
  const TimeSpan outage{100.0, 130.0};
  const auto fixes = Fixes({0.2, {outage}});
  EXPECT_EQ(fixes.size() + 6, Fixes({0.2, {}}).size());
  int unsure = 0;
  for (const GnssFix& fix : fixes) {
    const double time_s = kRtkClock.TimeAt(fix.stamp_ns) - 0.2;
    EXPECT_EQ(fix.status == "RTK_FLOAT", outage.Contains(time_s));
    EXPECT_EQ(fix.sigma_enu_m.x() > 0.1, outage.Contains(time_s));
    EXPECT_FALSE(time_s >= 112.0 && time_s < outage.end_s) << time_s;
    unsure += outage.Contains(time_s) ? 1 : 0;
  }
  EXPECT_EQ(unsure, 4);
}

// An outage changes nothing outside itself.
TEST_F(Rtk, OutageLeavesTheOtherFixesAsTheyWere) {
  const auto with = Fixes({0.0, {{100.0, 130.0}}}), without = Fixes({});
  EXPECT_EQ(with.front().latitude_deg, without.front().latitude_deg);
  EXPECT_EQ(with.back().latitude_deg, without.back().latitude_deg);
}

TEST_F(Rtk, RowsReadBack) {
  const auto fixes = Fixes({});
  std::stringstream stream;
  WriteRtkRows(stream, fixes);
  std::size_t count = 0;
  for (std::string line; std::getline(stream, line); ++count) {
    std::istringstream words(line);
    std::string stamp, status, rest;
    Geodetic position;
    Eigen::Vector3d sigma_neu_m;
    words >> stamp >> status >> position.latitude_deg >> position.longitude_deg >>
        position.altitude_m >> sigma_neu_m.x() >> sigma_neu_m.y() >> sigma_neu_m.z();
    ASSERT_TRUE(words) << line;
    EXPECT_FALSE(words >> rest) << line;
    const GnssFix& fix = fixes.at(count);
    EXPECT_EQ(ParseKatwijkStamp(stamp), fix.stamp_ns);
    EXPECT_EQ(status, fix.status);
    EXPECT_LT((local_.ToEnu(position) - EnuOf(fix)).norm(), 6e-4);  // m
    EXPECT_NEAR(sigma_neu_m.x(), fix.sigma_enu_m.y(), 1e-9);
    EXPECT_NEAR(sigma_neu_m.y(), fix.sigma_enu_m.x(), 1e-9);
  }
  EXPECT_EQ(count, fixes.size());
}

TEST_F(Rtk, FollowsItsSeed) {
  const auto once = Fixes({}), again = Fixes({});
  EXPECT_EQ(once.at(5).latitude_deg, again.at(5).latitude_deg);
  const auto other =
      SimulateRtk(motion_, mount_, local_, {kRtkClock.start_stamp_ns, kRtkClock.seed + 1}, {});
  EXPECT_NE(once.at(5).latitude_deg, other.at(5).latitude_deg);
}

}  // namespace
}  // namespace rigmap
