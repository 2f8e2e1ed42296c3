#include "core/job.h"

#include <gmock/gmock.h>
#include <oneapi/tbb/parallel_for.h>
#include <spdlog/spdlog.h>

#include <atomic>
#include <stdexcept>
#include <thread>

#include "core/file.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(JobTest, IsCurrentInItsWorkOnEveryThread) {
  EXPECT_EQ(Job::Current(), nullptr);
  Job job(2, true);
  std::atomic<int> of_this_job = 0;
  job.Run([&] {
    tbb::parallel_for(0, 1000, [&](int) { of_this_job += Job::Current() == &job ? 1 : 0; });
  });
  EXPECT_EQ(of_this_job, 1000);
  EXPECT_EQ(Job::Current(), nullptr);
}

TEST(JobTest, ReturnsWhatItsWorkReturnsAndThrows) {
  Job job(2, true);
  EXPECT_EQ(job.Run([] { return 7; }), 7);
  EXPECT_THROW(job.Run([] { throw std::runtime_error("no"); }), std::runtime_error);
  EXPECT_EQ(Job::Current(), nullptr);
}

TEST(JobTest, NestsWithFewerThreads) {
  Job job(2, true);
  job.Run([&] {
    std::atomic<int> others = 0;
    job.RunWithThreads(1, [&] {
      const auto self = std::this_thread::get_id();
      tbb::parallel_for(0, 200, [&](int) { others += std::this_thread::get_id() != self ? 1 : 0; });
    });
    EXPECT_EQ(others, 0);
    EXPECT_EQ(Job::Current(), &job);
  });
}

// Two parts in one process must not write into each other's logs.
TEST(JobTest, TwoAtATimeHaveTheirOwnLogs) {
  const TemporaryFolder folder;
  const auto work = [&](const std::string& name) {
    Job job(2, true);
    job.Run([&] {
      job.LogTo(folder.Path() / name);
      tbb::parallel_for(0, 200, [&](int i) { spdlog::info("{} says {}", name, i); });
    });
  };
  std::thread other(work, "b.log");
  work("a.log");
  other.join();
  const std::string a = ReadTextFile(folder.Path() / "a.log"),
                    b = ReadTextFile(folder.Path() / "b.log");
  EXPECT_EQ(std::count(a.begin(), a.end(), '\n'), 200);
  EXPECT_EQ(std::count(b.begin(), b.end(), '\n'), 200);
  EXPECT_THAT(a, Not(HasSubstr("b.log says")));
  EXPECT_THAT(b, Not(HasSubstr("a.log says")));
}

}  // namespace
}  // namespace rigmap
