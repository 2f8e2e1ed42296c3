#include "core/memory_peak.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>
#include <vector>

namespace rigmap {
namespace {

TEST(MemoryPeak, RemembersWhatWasGivenBack) {
  MemoryPeak peak;
  const double before_mb = peak.Megabytes();
  constexpr std::size_t kPeakMegabytes = 200;
  {
    std::vector<char> block(kPeakMegabytes << 20, 1);
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    EXPECT_EQ(block.back(), 1);
  }
  EXPECT_GT(peak.Megabytes(), before_mb + 0.9 * kPeakMegabytes);
}

TEST(MemoryPeak, StartsAnew) {
  {
    const std::vector<char> block(std::size_t{200} << 20, 1);
    EXPECT_EQ(block.front(), 1);
  }
  MemoryPeak first, second;
  EXPECT_NEAR(first.Megabytes(), second.Megabytes(), 50.0);
  EXPECT_GT(second.Megabytes(), 1.0);
}

}  // namespace
}  // namespace rigmap
