#include "core/freed_memory.h"

#include <gtest/gtest.h>

#include <vector>

#include "core/memory_peak.h"

namespace rigmap {
namespace {

constexpr double kMegabytes = 300.0;

// Resident after a block was asked for, written to and given back.
double AfterUsingABlock() {
  {
    const std::vector<char> block(static_cast<std::size_t>(kMegabytes) << 20, 1);
    EXPECT_EQ(block.back(), 1);
  }
  return ResidentMegabytes();
}

TEST(FreedMemory, IsKeptUntilReturned) {
#if !defined(__GLIBC__) || defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "another allocator";
#endif
  ReturnFreedMemory();
  const double before_mb = ResidentMegabytes();
  KeepFreedMemory();
  EXPECT_GT(AfterUsingABlock(), before_mb + 0.9 * kMegabytes);
  EXPECT_LT(AfterUsingABlock(), before_mb + 1.1 * kMegabytes);  // the same block again
  ReturnFreedMemory(before_mb + 2.0 * kMegabytes);
  EXPECT_GT(ResidentMegabytes(), before_mb + 0.9 * kMegabytes);
  ReturnFreedMemory(before_mb + 0.5 * kMegabytes);
  EXPECT_LT(ResidentMegabytes(), before_mb + 0.1 * kMegabytes);
}

}  // namespace
}  // namespace rigmap
