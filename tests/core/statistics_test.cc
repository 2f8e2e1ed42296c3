#include "core/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace rigmap {
namespace {

TEST(Statistics, MedianIsTheMiddleOne) {
  EXPECT_EQ(Median(std::vector<double>{5.0, -1.0, 3.0}), 3.0);
  EXPECT_EQ(Median(std::vector<double>{4.0, 1.0}), 4.0);
  EXPECT_EQ(Median(std::vector<float>{2.0F}), 2.0F);
  EXPECT_EQ(MedianAbsolute(std::vector<double>{-5.0, 1.0, -2.0}), 2.0);
}

TEST(Statistics, QuantilesRunFromLeastToGreatest) {
  const std::vector<int> values{7, 3, 9, 1, 5};
  EXPECT_EQ(Quantile(values, 0.0), 1);
  EXPECT_EQ(Quantile(values, 0.5), 5);
  EXPECT_EQ(Quantile(values, 1.0), 9);
}

TEST(Statistics, QuantileInTheOrderOfAKey) {
  const std::vector<std::string> words{"long word", "a", "word"};
  EXPECT_EQ(Quantile(words, 0.5, [](const std::string& word) { return word.size(); }), "word");
}

TEST(Statistics, WhatIsNoNumberIsNoAgreement) {
  EXPECT_EQ(RootOfSquares(9.0), 3.0);
  EXPECT_EQ(RootOfSquares(-1e-18), 0.0) << "rounding";
  EXPECT_TRUE(std::isinf(RootOfSquares(std::nan(""))));
}

}  // namespace
}  // namespace rigmap
