#include "dataset/inclinometer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/dataset/sample_data.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr StampNs kMillisecond = 1'000'000;
const StampNs kStart = ParseKatwijkStamp("2015_11_26_15_23_36_0");

std::string Row(int milliseconds, double x) {
  return FormatKatwijkStamp(kStart + milliseconds * kMillisecond) + " 9 9 9 8 8 8 " +
         std::to_string(x) + " -0.5 9.75\n";
}

std::vector<StereoFrame> Frames(std::initializer_list<int> milliseconds) {
  std::vector<StereoFrame> frames;
  for (const int ms : milliseconds) frames.push_back({kStart + ms * kMillisecond, "", ""});
  return frames;
}

class InclinometerTest : public testing::Test {
 protected:
  InclinometerReading Read(const std::string& text, const std::vector<StereoFrame>& frames) const {
    return ReadInclinometer(folder_.Write("imu.txt", text), frames);
  }
  TemporaryFolder folder_;
};

TEST_F(InclinometerTest, MeanOfTheRowsWithinHalfASecond) {
  const auto reading = Read(
      Row(499, 100) + Row(500, 1) + Row(1000, 2) + Row(1500, 6) + Row(1501, 100) + Row(2600, -4),
      Frames({1000, 3000}));
  ASSERT_EQ(reading.samples.size(), 2U);
  EXPECT_EQ(reading.samples[0].stamp_ns, kStart + 1000 * kMillisecond);
  EXPECT_TRUE(reading.samples[0].acceleration_in_imu.isApprox(Eigen::Vector3d(3.0, -0.5, 9.75)));
  EXPECT_TRUE(reading.samples[1].acceleration_in_imu.isApprox(Eigen::Vector3d(-4.0, -0.5, 9.75)));
  EXPECT_THAT(reading.remarks, IsEmpty());
}

TEST_F(InclinometerTest, WindowsMayOverlapAndRowsStandInAnyOrder) {
  const auto frames = Frames({1000, 1400, 1800});
  const std::string a = Row(900, 1), b = Row(1200, 2), c = Row(1600, 4);
  const auto forwards = Read(a + b + c, frames), backwards = Read(c + b + a, frames);
  ASSERT_EQ(forwards.samples.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_TRUE(
        forwards.samples[i].acceleration_in_imu.isApprox(backwards.samples[i].acceleration_in_imu));
  }
  EXPECT_NEAR(forwards.samples[0].acceleration_in_imu.x(), 1.5, 1e-9) << "m/s^2";
  EXPECT_NEAR(forwards.samples[1].acceleration_in_imu.x(), 7.0 / 3.0, 1e-6) << "m/s^2";
  EXPECT_NEAR(forwards.samples[2].acceleration_in_imu.x(), 4.0, 1e-9) << "m/s^2";
}

TEST_F(InclinometerTest, MalformedRowsAreCountedWithTheFirstLine) {
  std::string nan_row = Row(1000, 5);
  nan_row.replace(nan_row.find("5.0"), 3, "nan");
  const auto reading = Read(Row(1000, 1) + "\nnonsense\n" + "2015_11_26_15_23_37_0 1 2 3\n" +
                                nan_row + Row(1010, 3).insert(Row(1010, 3).size() - 1, " 7") +
                                Replaced(Row(1020, 3), "\n", "\r\n"),
                            Frames({1000}));
  ASSERT_EQ(reading.samples.size(), 1U);
  EXPECT_NEAR(reading.samples[0].acceleration_in_imu.x(), 2.0, 1e-9) << "m/s^2";
  EXPECT_THAT(reading.remarks,
              ElementsAre(HasSubstr("4 malformed rows left out, the first in line 3")));
}

TEST_F(InclinometerTest, FramesWithoutRowsAreRemarkedOn) {
  const auto reading = Read(Row(1000, 1), Frames({1000, 9000}));
  EXPECT_EQ(reading.samples.size(), 1U);
  EXPECT_THAT(reading.remarks, ElementsAre(HasSubstr("no rows within 0.5 s of 1 of 2 frames")));
}

TEST_F(InclinometerTest, MissingFileGivesNothing) {
  const auto reading = ReadInclinometer(folder_.Path() / "none.txt", Frames({1000}));
  EXPECT_THAT(reading.samples, IsEmpty());
  EXPECT_THAT(reading.remarks, IsEmpty());
}

TEST_F(InclinometerTest, RealRowsAreRead) {
  const auto data = SharedData();
  if (!data) GTEST_SKIP() << "RIGMAP_DATA is not set";
  const std::vector<StereoFrame> frames{{ParseKatwijkStamp("2015_11_26_12_53_35_149"), "", ""}};
  int read = 0;
  for (const auto& entry : std::filesystem::directory_iterator(*data / "katwijk-text")) {
    if (!entry.path().filename().string().starts_with("imu")) continue;
    ++read;
    const auto reading = ReadInclinometer(entry.path(), frames);
    EXPECT_THAT(reading.remarks, IsEmpty());
    ASSERT_EQ(reading.samples.size(), 1U);
    EXPECT_NEAR(reading.samples[0].acceleration_in_imu.norm(), 9.81, 0.2) << "m/s^2";
  }
  EXPECT_GT(read, 0);
}

}  // namespace
}  // namespace rigmap
