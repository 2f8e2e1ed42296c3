#include "core/progress.h"

#include <gmock/gmock.h>

#include <thread>
#include <vector>

#include "core/job.h"

namespace rigmap {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

// Tests run without a terminal on stderr: capturing makes sure of it.
TEST(Progress, CountsTheStepsOfAllThreads) {
  testing::internal::CaptureStderr();
  {
    Progress progress("dense", 400);
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t) {
      threads.emplace_back([&] {
        for (int i = 0; i < 100; ++i) progress.Advance();
      });
    }
    for (auto& thread : threads) thread.join();
  }
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("dense: 400/400"));
}

TEST(Progress, NeverClaimsMoreThanThereIs) {
  testing::internal::CaptureStderr();
  {
    Progress progress("mapping", 10);
    progress.Set(25);
  }
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("mapping: 10/10"));
}

TEST(Progress, IsSilentInAQuietJob) {
  testing::internal::CaptureStderr();
  Job job(1, true);
  job.Run([] {
    Progress progress("dense", 2);
    progress.Advance(2);
  });
  EXPECT_THAT(testing::internal::GetCapturedStderr(), IsEmpty());
}

}  // namespace
}  // namespace rigmap
