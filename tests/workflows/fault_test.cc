// What happens to a part when its disk fails or its user ends it.
#include <signal.h>
#include <sys/mount.h>
#include <unistd.h>

#include "tests/workflows/faulty_run.h"

namespace rigmap {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

// ---- Disks ----

// A mount that ends with this object; not there where it is not permitted.
class Mount {
 public:
  Mount(const char* what, const fs::path& on, const char* type, unsigned long flags,
        const std::string& options)
      : on_(on), mounted_(mount(what, on.c_str(), type, flags, options.c_str()) == 0) {}
  ~Mount() {
    if (mounted_) umount2(on_.c_str(), MNT_DETACH);
  }
  Mount(const Mount&) = delete;
  Mount& operator=(const Mount&) = delete;

  bool IsThere() const { return mounted_; }
  bool Change(unsigned long flags, const char* options) const {
    return mount(nullptr, on_.c_str(), nullptr, MS_REMOUNT | flags, options) == 0;
  }

 private:
  fs::path on_;
  bool mounted_;
};

TEST_F(FaultTest, FullDiskIsSaidAndWithRoomTheRunGoesOn) {
  Succeeds(undisturbed_);
  const fs::path disk = folder_.Path() / "disk";
  fs::create_directories(disk);
  // Full at once, near the database, in the dense maps.
  for (const char* size : {"size=16k", "size=6000k", "size=8000k"}) {
    const Mount mount("tmpfs", disk, "tmpfs", 0, size);
    if (!mount.IsThere()) GTEST_SKIP() << "mounting is not permitted here";
    const std::string message = Fails(disk / "out");
    EXPECT_THAT(message, AllOf(HasSubstr((disk / "out").string()),
                               testing::AnyOf(HasSubstr("No space left"), HasSubstr("is full"))))
        << size;
    ASSERT_TRUE(mount.Change(0, "size=100m"));
    Succeeds(disk / "out");
    EXPECT_TRUE(ResultOf(disk / "out") == ResultOf(undisturbed_)) << size;
  }
}

TEST_F(FaultTest, ReadOnlyOutputIsSaidAndLeftAsItIs) {
  const fs::path disk = folder_.Path() / "disk";
  fs::create_directories(disk);
  Succeeds(disk / "done");
  const auto before = FilesIn(disk);
  const Mount mount(disk.c_str(), disk, nullptr, MS_BIND, "");
  if (!mount.IsThere() || !mount.Change(MS_BIND | MS_RDONLY, "")) {
    GTEST_SKIP() << "mounting is not permitted here";
  }
  for (const char* out : {"new", "done"}) {
    EXPECT_THAT(Fails(disk / out, {"--force"}),
                AllOf(HasSubstr((disk / out).string()), HasSubstr("Read-only file system")));
  }
  EXPECT_EQ(FilesIn(disk), before);
}

// ---- Users ----

TEST_F(FaultTest, InterruptedRunIsTakenUpAgain) {
  Succeeds(undisturbed_);
  using Case = std::pair<int, const char*>;
  for (const auto& [signal, moment] :
       {Case{SIGINT, "logs/mapping.log"}, Case{SIGTERM, "stages/features"}}) {
    fs::remove_all(out_);
    const pid_t process = StartRigmap(Arguments(out_));
    for (int waited_ms = 0; !fs::exists(out_ / moment) && waited_ms < 60000; ++waited_ms) {
      usleep(1000);
    }
    EXPECT_EQ(EndBySignal(process, signal), signal);
    for (int waited_ms = 0; ProcessesOn(out_) > 0 && waited_ms < 5000; ++waited_ms) usleep(1000);
    EXPECT_EQ(ProcessesOn(out_), 0) << "a child outlived its parent at " << moment;
    EXPECT_FALSE(fs::exists(out_ / "summary.json"));
    Succeeds(out_);
    EXPECT_TRUE(ResultOf(out_) == ResultOf(undisturbed_)) << moment;
  }
}

// Else the summary of the run before would speak for what is no longer there.
TEST_F(FaultTest, InterruptedRunLeavesNoSummaryOfTheOneBefore) {
  Succeeds(out_);
  const pid_t process = StartRigmap(Arguments(out_, {"--from", "dataset"}));
  for (int waited_ms = 0; fs::exists(out_ / "trajectory.tum") && waited_ms < 60000; ++waited_ms) {
    usleep(1000);
  }
  KillHard(process);
  EXPECT_FALSE(fs::exists(out_ / "trajectory.tum"));
  EXPECT_FALSE(fs::exists(out_ / "summary.json"));
}

}  // namespace
}  // namespace rigmap
