#include "core/memory_share.h"

#include <gtest/gtest.h>

#include "core/job.h"
#include "core/memory_peak.h"

namespace rigmap {
namespace {

TEST(MemoryShareTest, IsWhatIsFreeAmongTheJobsAtWork) {
  constexpr double kAllowed_mb = 10000.0;
  const double free_mb = kAllowed_mb - ResidentMegabytes();
  EXPECT_NEAR(MemoryShare(kAllowed_mb), free_mb, 100.0);
  Job one(1, true);
  one.Run([&] { EXPECT_NEAR(MemoryShare(kAllowed_mb), free_mb, 100.0); });
  Job one_of_four(1, true, 4);
  one_of_four.Run([&] { EXPECT_NEAR(MemoryShare(kAllowed_mb), free_mb / 4.0, 100.0); });
  EXPECT_LT(MemoryShare(1.0), 0.0);
}

}  // namespace
}  // namespace rigmap
