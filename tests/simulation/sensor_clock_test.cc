#include "simulation/sensor_clock.h"

#include <gtest/gtest.h>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

constexpr StampNs kNsPerMillisecond = 1'000'000;
constexpr StampNs kStartNs = 1'448'551'416'849 * kNsPerMillisecond;

TEST(RecordedStamp, ReadsBack) {
  for (StampNs ms = 0; ms < 3000; ++ms) {
    const StampNs stamp_ns = kStartNs + ms * kNsPerMillisecond;
    EXPECT_EQ(ParseKatwijkStamp(FormatKatwijkStampAsRecorded(stamp_ns)), stamp_ns);
  }
}

TEST(RecordedStamp, WholeSecondBelongsToTheSecondBefore) {
  const StampNs midnight_ns = ParseKatwijkStamp("2015_12_01_00_00_00_0");
  EXPECT_EQ(FormatKatwijkStampAsRecorded(midnight_ns), "2015_11_30_23_59_59_1000");
  EXPECT_EQ(FormatKatwijkStampAsRecorded(midnight_ns + 5 * kNsPerMillisecond),
            "2015_12_01_00_00_00_5");
  EXPECT_EQ(FormatKatwijkStampAsRecorded(midnight_ns + 100 * kNsPerMillisecond),
            "2015_12_01_00_00_00_100");
}

TEST(SensorClock, StampsAreWholeMillisecondsNearTheTime) {
  SeededRandom random;
  const SensorClock clock{kStartNs, 1};
  for (int i = 0; i < 200; ++i) {
    const double time_s = random.Uniform(-5.0, 2000.0);
    const StampNs stamp_ns = clock.StampAt(time_s);
    EXPECT_EQ(stamp_ns % kNsPerMillisecond, 0);
    EXPECT_NEAR(clock.TimeAt(stamp_ns), time_s, 0.5001e-3);
  }
}

}  // namespace
}  // namespace rigmap
