#include "core/option_range.h"

#include <gtest/gtest.h>

#include <limits>

namespace rigmap {
namespace {

TEST(OptionRange, HoldsItsEndsUnlessTheyAreExcluded) {
  const OptionRange closed = AtLeast(0.0).UpTo(1.0), open = MoreThan(0.0).Below(1.0);
  for (const double end : {0.0, 1.0}) {
    EXPECT_TRUE(closed.Holds(end)) << end;
    EXPECT_FALSE(open.Holds(end)) << end;
  }
  for (const double outside : {-1e-9, 1.0 + 1e-9}) {
    EXPECT_FALSE(closed.Holds(outside)) << outside;
    EXPECT_FALSE(open.Holds(outside)) << outside;
  }
  EXPECT_TRUE(open.Holds(1e-300));
}

TEST(OptionRange, WithoutLimitsHoldsAll) {
  for (const double value : {-1e300, 0.0, 1e300}) EXPECT_TRUE(OptionRange().Holds(value)) << value;
}

TEST(OptionRange, HoldsNoNumberWithoutEnd) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double value : {infinity, -infinity, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_FALSE(OptionRange().Holds(value)) << value;
    EXPECT_FALSE(MoreThan(0.0).Holds(value)) << value;
  }
}

TEST(OptionRange, OddMeansOdd) {
  for (int value = -6; value <= 6; ++value) {
    EXPECT_EQ(OptionRange().Odd().Holds(value), value % 2 != 0) << value;
  }
}

TEST(OptionRange, SaysWhatItHolds) {
  EXPECT_EQ(OptionRange().Text(), "any number");
  EXPECT_EQ(AtLeast(6).Text(), "at least 6");
  EXPECT_EQ(MoreThan(0.0).Text(), "more than 0");
  EXPECT_EQ(AtLeast(1e-4).UpTo(0.5).Text(), "0.0001 to 0.5");
  EXPECT_EQ(MoreThan(0.0).UpTo(180.0).Text(), "more than 0, at most 180");
  EXPECT_EQ(AtLeast(0.0).Below(0.5).Text(), "at least 0, less than 0.5");
  EXPECT_EQ(AtLeast(1).Odd().Text(), "at least 1, odd");
}

}  // namespace
}  // namespace rigmap
