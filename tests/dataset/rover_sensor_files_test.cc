#include "dataset/rover_sensor_files.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr StampNs kMs = 1'000'000;
const StampNs kBegin = ParseKatwijkStamp("2015_11_26_15_23_36_0");
constexpr double kWheelRate_radps = 2.0, kSteering_rad = 0.1;

std::string Stamp(int ms) { return FormatKatwijkStamp(kBegin + ms * kMs); }

// All wheels at the same rate since time 0, their angles counted from 0 to a full turn.
std::string WheelRow(int ms) {
  const double angle_rad = std::fmod(1e-3 * ms * kWheelRate_radps, 2.0 * M_PI);
  std::string row = Stamp(ms);
  for (int i = 0; i < 6; ++i) row += fmt::format(" {} {} 0.7", angle_rad, kWheelRate_radps);
  for (int i = 0; i < 4; ++i) row += fmt::format(" {} 0 0.4", kSteering_rad + i);
  return row + " -0.01 0.02 0.03\n";
}

std::string ImuRow(int ms, const std::string& numbers = "0.4 0.2 9.7 0.01 0.02 0.03 0.2 0.1 9.8") {
  return Stamp(ms) + " " + numbers + "\n";
}

std::string Rows(std::string (*row)(int), int end_ms, int step_ms) {
  std::string text;
  for (int ms = 0; ms < end_ms; ms += step_ms) text += row(ms);
  return text;
}
std::string WheelRows() { return Rows(WheelRow, 10'000, 80); }
std::string ImuRows() {
  return Rows([](int ms) { return ImuRow(ms); }, 10'000, 8);
}

class RoverSensorFilesTest : public testing::Test {
 protected:
  RoverSensorReading Read(const std::string& wheels, const std::string& imu) const {
    folder_.Write("odometry.txt", wheels);
    folder_.Write("imu.txt", imu);
    return ReadRoverSensors(folder_.Path(), frames_);
  }
  TemporaryFolder folder_;
  std::vector<StereoFrame> frames_{{kBegin + 1000 * kMs, "", ""}, {kBegin + 9000 * kMs, "", ""}};
};

TEST_F(RoverSensorFilesTest, ReadsJointsAndInertialUnit) {
  const auto reading = Read(WheelRows(), ImuRows());
  EXPECT_EQ(reading.wheels.problem, "");
  EXPECT_EQ(reading.inertial.problem, "");
  EXPECT_THAT(reading.remarks, IsEmpty());
  ASSERT_EQ(reading.wheels.samples.size(), 125U);
  ASSERT_EQ(reading.inertial.samples.size(), 1250U);
  const WheelSample& wheel = reading.wheels.samples[1];
  EXPECT_EQ(wheel.stamp_ns, kBegin + 80 * kMs);
  EXPECT_EQ(wheel.drive_rate_radps[5], kWheelRate_radps);
  EXPECT_EQ(wheel.steering_rad[3], kSteering_rad + 3);
  const InertialSample& inertial = reading.inertial.samples[1];
  EXPECT_EQ(inertial.angular_rate_radps, Eigen::Vector3d(0.01, 0.02, 0.03));
  EXPECT_EQ(inertial.inclination_mps2, Eigen::Vector3d(0.2, 0.1, 9.8));
}

TEST_F(RoverSensorFilesTest, AnglesGoOnOverFullTurns) {
  const auto reading = Read(WheelRows(), ImuRows());
  ASSERT_FALSE(reading.wheels.samples.empty());
  for (const WheelSample& sample : reading.wheels.samples) {
    const double seconds = 1e-9 * static_cast<double>(sample.stamp_ns - kBegin);
    EXPECT_NEAR(sample.drive_angle_rad[2], kWheelRate_radps * seconds, 1e-9) << "rad";
  }
}

// Two parts of one drive, each of which counts from its own start.
TEST_F(RoverSensorFilesTest, AnglesGoOnWhereRecordsThatWereReadApartMeet) {
  const auto part = [&](int begin_ms, int end_ms) {
    std::string rows;
    for (int ms = begin_ms; ms < end_ms; ms += 80) rows += WheelRow(ms);
    return Read(rows, ImuRows()).wheels.samples;
  };
  std::vector<WheelSample> whole = part(0, 6000);
  const auto second = part(6000, 10'000);
  ASSERT_EQ(whole.size() + second.size(), 125U);
  whole.insert(whole.end(), second.begin(), second.end());
  UnwrapDriveAngles(whole);
  for (const WheelSample& sample : whole) {
    const double seconds = 1e-9 * static_cast<double>(sample.stamp_ns - kBegin);
    EXPECT_NEAR(sample.drive_angle_rad[4], kWheelRate_radps * seconds, 1e-9) << "rad";
  }
}

TEST_F(RoverSensorFilesTest, ReadsRealExcerpts) {
  const auto reading = Read(
      "2015_11_26_15_23_36_149 0 0 0.782989979 0 0 0.713249981 0 0 0.0697399974 0 0 0.374060005 0 "
      "0 0.653020024 0 0 0.608640015 5.53384122613868e-06 0 0.00206399988 -3.32030473568321e-06 0 "
      "0 0 0 0.0159959998 0 0 -0.00103199994 -0.00849777774449908 -0.00551165979119766 "
      "0.0252350293227374\n",
      "2015_11_26_15_23_36_149 0.414140773105621 0.276689281702042 9.75365023121834 "
      "-0.00511433455738817 0.00451246015103026 1.81094954125388e-05 0.279597862625122 "
      "0.20772505106926 9.83496424033642\n");
  EXPECT_EQ(reading.wheels.problem + reading.inertial.problem, "");
  EXPECT_EQ(reading.wheels.samples.size(), 1U);
  EXPECT_EQ(reading.inertial.samples.size(), 1U);
}

TEST_F(RoverSensorFilesTest, MissingFilesAreNamed) {
  const auto reading = ReadRoverSensors(folder_.Path(), frames_);
  EXPECT_THAT(reading.wheels.problem,
              AllOf(HasSubstr("odometry.txt: expected rows"), HasSubstr("found no such file")));
  EXPECT_THAT(reading.inertial.problem,
              AllOf(HasSubstr("imu.txt: expected rows"), HasSubstr("found no such file")));
}

TEST_F(RoverSensorFilesTest, RowsThatAreNoNumbersAreLeftOut) {
  std::string rows = WheelRows();
  const auto third = rows.find(Stamp(160));
  rows.replace(rows.find(" 2 ", third), 3, " nan ");
  const auto reading = Read(rows + "nonsense\n", ImuRows());
  EXPECT_EQ(reading.wheels.problem, "");
  EXPECT_EQ(reading.wheels.samples.size(), 124U);
  EXPECT_THAT(reading.remarks,
              ElementsAre(HasSubstr("2 rows that are malformed or repeat a stamp left out, the "
                                    "first in line 3")));
}

TEST_F(RoverSensorFilesTest, OnlyOtherRowsAreAProblem) {
  const auto reading = Read(ImuRows(), WheelRows());
  EXPECT_THAT(reading.wheels.problem, HasSubstr("33 numbers of the rover's joints, found none"));
  EXPECT_THAT(reading.inertial.problem, HasSubstr("9 numbers of the inertial unit, found none"));
}

TEST_F(RoverSensorFilesTest, AClockThatGoesBackIsAProblem) {
  const auto reading = Read(WheelRows() + WheelRow(5000), ImuRows() + ImuRow(9000));
  EXPECT_THAT(reading.wheels.problem,
              HasSubstr("odometry.txt:126: expected rising stamps, found one 4.920 s before"));
  EXPECT_THAT(reading.inertial.problem, HasSubstr("imu.txt:1251: expected rising stamps"));
}

// Neither is a problem: images may bridge it.
TEST_F(RoverSensorFilesTest, AClockThatJumpsForwardsIsNamed) {
  std::string wheels, imu;
  for (int ms = 0; ms < 20'000; ms += 80) wheels += WheelRow(ms < 5000 ? ms : ms + 60'000);
  for (int ms = 0; ms < 10'000; ms += 8) {
    if (ms < 3000 || ms >= 4200) imu += ImuRow(ms);
  }
  const auto reading = Read(wheels, imu);
  EXPECT_EQ(reading.wheels.problem + reading.inertial.problem, "");
  EXPECT_THAT(
      reading.remarks,
      ElementsAre(
          AllOf(HasSubstr("odometry.txt:64: expected rows about every 0.08 s, found none "
                          "for 60.080 s from 3.96 s after the first image"),
                HasSubstr("the clock jumped forwards")),
          HasSubstr("imu.txt:376: expected rows about every 0.008 s, found none for 1.208")));
}

TEST_F(RoverSensorFilesTest, GapsBesideTheImagesAreNoMatterAndManyAreCounted) {
  std::string imu;
  for (int ms = -20'000; ms < 12'000; ms += 8) {
    const bool before = ms > -10'000 && ms<-5000, behind = ms> 9500 && ms < 10'500;
    if (!before && !behind) imu += ImuRow(ms);
  }
  EXPECT_THAT(Read(WheelRows(), imu).remarks, IsEmpty());
  imu.clear();
  for (int ms = 0; ms < 10'000; ms += 8) {
    if (ms % 1400 < 700) imu += ImuRow(ms);
  }
  const auto remarks = Read(WheelRows(), imu).remarks;
  ASSERT_EQ(remarks.size(), 6U);
  EXPECT_THAT(remarks.back(), HasSubstr("imu.txt: and 1 more such gaps"));
}

TEST_F(RoverSensorFilesTest, RowsOfAnotherTimeAreAProblem) {
  frames_ = {{kBegin + 3'600'000 * kMs, "", ""}};
  EXPECT_THAT(Read(WheelRows(), ImuRows()).wheels.problem,
              HasSubstr("expected rows at the time of the images, found none"));
}

TEST_F(RoverSensorFilesTest, DrivesInTheColumnsOfSteeringAreAProblem) {
  std::string wheels;
  for (int ms = 0; ms < 10'000; ms += 80) {
    wheels += Stamp(ms);
    for (int i = 0; i < 6; ++i) wheels += " 0.2 0 0.7";
    for (int i = 0; i < 4; ++i) {
      wheels += fmt::format(" {} {} 0.7", 1e-3 * ms * kWheelRate_radps, kWheelRate_radps);
    }
    wheels += " 0 0 0\n";
  }
  EXPECT_THAT(Read(wheels, ImuRows()).wheels.problem,
              AllOf(HasSubstr("expected steering joint 1 (field 20) to stay within half a turn"),
                    HasSubstr("are columns exchanged")));
}

TEST_F(RoverSensorFilesTest, RatesInDegreesAreAProblem) {
  std::string wheels;
  constexpr double kRate = 90.0;  // degrees a second
  for (int ms = 0; ms < 10'000; ms += 80) {
    wheels += Stamp(ms);
    for (int i = 0; i < 6; ++i) wheels += fmt::format(" {} {} 0.7", 1e-3 * ms * kRate, kRate);
    for (int i = 0; i < 4; ++i) wheels += " 0.1 0 0.4";
    wheels += " 0 0 0\n";
  }
  EXPECT_THAT(Read(wheels, ImuRows()).wheels.problem,
              AllOf(HasSubstr("rates of drive 1 (field 3) below 30 rad/s, found 90"),
                    HasSubstr("in degrees?")));
}

// Of a rover that turns by 12 degrees a second now and then, else not at all.
TEST_F(RoverSensorFilesTest, AngularRatesInDegreesAreAProblem) {
  const auto rows = [](double per_radian) {
    std::string imu;
    for (int ms = 0; ms < 10'000; ms += 8) {
      imu += ImuRow(ms, fmt::format("0.4 0.2 9.7 0 0 {} 0.2 0.1 9.8",
                                    ms % 1000 < 100 ? 0.21 * per_radian : 0.0));
    }
    return imu;
  };
  EXPECT_THAT(Read(WheelRows(), rows(1.0)).inertial.problem, IsEmpty());
  EXPECT_THAT(Read(WheelRows(), rows(57.3)).inertial.problem,
              AllOf(HasSubstr("angular rates below 3 rad/s in fields 5 to 7, found 12.03"),
                    HasSubstr("rates in degrees?")));
}

TEST_F(RoverSensorFilesTest, ExchangedColumnsAreAProblem) {
  std::string wheels, imu;
  for (int ms = 0; ms < 10'000; ms += 80) {
    const double angle_rad = 1e-3 * ms * kWheelRate_radps;
    wheels += Stamp(ms);
    for (int i = 0; i < 6; ++i) wheels += fmt::format(" {} {} 0.7", kWheelRate_radps, angle_rad);
    wheels += " 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0\n";
    imu += ImuRow(ms, "0.4 0.2 9.7 0.2 0.1 9.8 0.01 0.02 0.03");
  }
  const auto reading = Read(wheels, imu);
  EXPECT_THAT(reading.wheels.problem, AllOf(HasSubstr("the angle of drive 1 (field 2)"),
                                            HasSubstr("are columns exchanged?")));
  EXPECT_THAT(reading.inertial.problem,
              AllOf(HasSubstr("expected gravity"), HasSubstr("found (0.01, 0.02, 0.03)")));
  EXPECT_EQ(reading.inclinometer_problem, reading.inertial.problem);
  // Nor are they believed where the clock goes back as well.
  EXPECT_EQ(Read(wheels, imu + ImuRow(5000)).inclinometer_problem, reading.inclinometer_problem);
}

}  // namespace
}  // namespace rigmap
