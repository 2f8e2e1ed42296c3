#include "core/stamp.h"

#include <gtest/gtest.h>

#include <random>

#include "core/error.h"

namespace rigmap {
namespace {

constexpr StampNs kSecond = 1'000'000'000;

TEST(SecondsTest, FormatAndParseAreInverse) {
  std::mt19937_64 random(20151126);
  std::uniform_int_distribution<StampNs> stamps(-4'000'000'000 * kSecond, 4'000'000'000 * kSecond);
  for (int i = 0; i < 1000; ++i) {
    const StampNs stamp_ns = stamps(random);
    EXPECT_EQ(ParseSeconds(FormatSeconds(stamp_ns)), stamp_ns);
  }
}

TEST(SecondsTest, FormatIsExact) {
  EXPECT_EQ(FormatSeconds(1448551416619000000), "1448551416.619000000");
  EXPECT_EQ(FormatSeconds(0), "0.000000000");
  EXPECT_EQ(FormatSeconds(-1), "-0.000000001");
}

TEST(SecondsTest, DecimalsBeyondNanosecondsAreRounded) {
  EXPECT_EQ(ParseSeconds("1.0000000014"), kSecond + 1);
  EXPECT_EQ(ParseSeconds("1.0000000015"), kSecond + 2);
  EXPECT_EQ(ParseSeconds("0.99999999999"), kSecond);
  EXPECT_EQ(ParseSeconds("-1.0000000015"), -kSecond - 2);
}

TEST(SecondsTest, ShortForms) {
  EXPECT_EQ(ParseSeconds("7"), 7 * kSecond);
  EXPECT_EQ(ParseSeconds("7."), 7 * kSecond);
  EXPECT_EQ(ParseSeconds(".5"), kSecond / 2);
  EXPECT_EQ(ParseSeconds("+7.5"), 15 * kSecond / 2);
}

// As numpy.savetxt writes times: a double would be off by up to 119 ns.
TEST(SecondsTest, ExponentFormKeepsEveryDigit) {
  EXPECT_EQ(ParseSeconds("1.403715273262142976e+09"), 1403715273262142976);
  EXPECT_EQ(ParseSeconds("1.403715273262142976E9"), 1403715273262142976);
  EXPECT_EQ(ParseSeconds("-2.5e-01"), -kSecond / 4);
  EXPECT_EQ(ParseSeconds("0.000000000000000000e+00"), 0);
  EXPECT_EQ(ParseSeconds("5e-9"), 5);
  EXPECT_EQ(ParseSeconds("12e3"), 12000 * kSecond);
  EXPECT_EQ(ParseSeconds("125e-1"), 25 * kSecond / 2);
}

TEST(SecondsTest, RefusesWhatIsNoTime) {
  for (const char* text : {"",
                           "-",
                           ".",
                           "+.",
                           "abc",
                           "1.2.3",
                           "1,5",
                           " 1",
                           "1 ",
                           "nan",
                           "inf",
                           "--1",
                           "1e",
                           "e5",
                           "1e5.0",
                           "1e99",
                           "1e+-3",
                           "0x10",
                           "1e-41",
                           "+-1",
                           "99999999999",
                           "1e30",
                           "999999999999999999999"}) {
    EXPECT_THROW(ParseSeconds(text), DataError) << text;
  }
}

TEST(KatwijkStampTest, MillisecondsAreAnIntegerNotAFraction) {
  const StampNs second = ParseKatwijkStamp("2015_11_26_15_23_36_0");
  EXPECT_EQ(ParseKatwijkStamp("2015_11_26_15_23_36_5") - second, 5'000'000);
  EXPECT_EQ(ParseKatwijkStamp("2015_11_26_15_23_36_50") - second, 50'000'000);
  EXPECT_EQ(ParseKatwijkStamp("2015_11_26_15_23_36_005") - second, 5'000'000);
  EXPECT_EQ(ParseKatwijkStamp("2015_11_26_15_23_36_1000"),
            ParseKatwijkStamp("2015_11_26_15_23_37_0"));
}

TEST(KatwijkStampTest, IsUtc) {
  EXPECT_EQ(ParseKatwijkStamp("1970_01_01_00_00_00_0"), 0);
  EXPECT_EQ(ParseKatwijkStamp("2015_11_26_15_23_36_619"), 1448551416619000000);
}

TEST(KatwijkStampTest, ThousandMillisecondsCarryOverMidnightAndNewYear) {
  EXPECT_EQ(ParseKatwijkStamp("2015_12_31_23_59_59_1000"),
            ParseKatwijkStamp("2016_01_01_00_00_00_0"));
}

TEST(KatwijkStampTest, FormatAndParseAreInverse) {
  std::mt19937_64 random(3);
  std::uniform_int_distribution<StampNs> milliseconds(0, 4'000'000'000'000);
  for (int i = 0; i < 1000; ++i) {
    const StampNs stamp_ns = milliseconds(random) * 1'000'000;
    EXPECT_EQ(ParseKatwijkStamp(FormatKatwijkStamp(stamp_ns)), stamp_ns);
  }
  EXPECT_EQ(FormatKatwijkStamp(1448551416005000000), "2015_11_26_15_23_36_5");
}

TEST(KatwijkStampTest, RefusesGarbage) {
  for (const char* text :
       {"", "2015", "2015_11_26_15_23_36", "2015_11_26_15_23_36_", "2015_11_26_15_23_36_1001",
        "2015_13_26_15_23_36_5", "1500_01_01_00_00_00_0", "2015_267_26_15_23_36_5",
        "2015_11_282_15_23_36_5", "2015_02_30_15_23_36_5", "2015_11_26_24_23_36_5",
        "2015_11_26_15_60_36_5", "2015_11_26_15_23_61_5", "2015_11_26_15_23_36_-5",
        "2015_11_26_15_23_36_5_0", "2015_11_26_15_23_36_5a", "2015-11-26_15_23_36_5",
        "x2015_11_26_15_23_36_5"}) {
    EXPECT_THROW(ParseKatwijkStamp(text), DataError) << text;
  }
}

}  // namespace
}  // namespace rigmap
