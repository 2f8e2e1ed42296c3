// What happens to a part when its images, its disk, COLMAP or its user fail.
#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/mount.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "core/file.h"
#include "export/tum.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_file.h"
#include "tests/workflows/rigmap_program.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AllOf;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

class FaultTest : public testing::Test {
 protected:
  std::vector<std::string> Arguments(const fs::path& out,
                                     const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"part", "--dataset", data_, "--out", out, "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  void Succeeds(const fs::path& out, const std::vector<std::string>& more = {}) const {
    const ProgramEnd end = RunRigmap(Arguments(out, more));
    EXPECT_EQ(end.exit_code, 0) << end.err;
  }
  // The last line of standard error of a run that ends with 1; nothing half-written may be left.
  static std::string LastWord(const ProgramEnd& end, const fs::path& out) {
    EXPECT_EQ(end.exit_code, 1) << end.err;
    EXPECT_THAT(end.LastErrorLine(), StartsWith("rigmap: "));
    if (fs::exists(out)) ExpectNothingUnfinished(out);
    return end.LastErrorLine();
  }
  std::string Fails(const fs::path& out, const std::vector<std::string>& more = {}) const {
    return LastWord(RunRigmap(Arguments(out, more)), out);
  }
  static void ExpectNothingUnfinished(const fs::path& out) {
    for (const std::string& name : FilesIn(out)) EXPECT_FALSE(IsTemporaryName(name)) << name;
  }
  static std::string ResultOf(const fs::path& out) {
    return ReadTextFile(out / "trajectory.tum") + ReadTextFile(out / "sparse.ply") +
           ReadTextFile(out / "dense.ply");
  }
  static json SummaryOf(const fs::path& out) {
    return json::parse(ReadTextFile(out / "summary.json"));
  }

  TemporaryFolder folder_;
  fs::path data_ = SimulatedPartFolder();
  fs::path out_ = folder_.Path() / "out", undisturbed_ = folder_.Path() / "undisturbed";
};

// ---- Images ----

class SpoiltImage : public FaultTest {
 protected:
  SpoiltImage() { data_ = CopyOfSimulatedPart(folder_.Path()); }

  // Every frame has a pose, that of the spoilt one is a guess between its neighbours' and within 15
  // cm of it (steps are 30 cm), and the summary names the image.
  void ExpectBridged(const std::string& image, std::size_t frame) {
    Succeeds(out_);
    const json summary = SummaryOf(out_);
    EXPECT_EQ(summary["frames"]["paired"], 8);
    EXPECT_EQ(summary["frames"]["posed"], 8);
    const std::vector<std::string> named = summary["health"]["unreadable_images"];
    EXPECT_THAT(named, ElementsAre(EndsWith(image)));
    const auto poses = ReadTum(out_ / "trajectory.tum");
    const auto truth = ReadTum(data_ / "groundtruth_tum.txt");
    ASSERT_EQ(poses.size(), 8U);
    const auto distance_m = [](const std::vector<TumPose>& path, std::size_t a, std::size_t b) {
      return (path[b].world_from_body.translation - path[a].world_from_body.translation).norm();
    };
    EXPECT_NEAR(distance_m(poses, 0, frame), distance_m(truth, 0, frame), 0.15);
    EXPECT_NEAR(distance_m(poses, 0, 7), distance_m(truth, 0, 7), 0.03);
    EXPECT_THAT(ReadTextFile(out_ / "logs" / "features.log"), HasSubstr(image));
  }
};

TEST_F(SpoiltImage, ThatIsTruncatedIsBridged) {
  const fs::path image = data_ / "left" / "0004.png";
  fs::resize_file(image, fs::file_size(image) / 2);
  ExpectBridged("left/0004.png", 4);
}

TEST_F(SpoiltImage, ThatIsEmptyIsBridged) {
  fs::resize_file(data_ / "right" / "0002.png", 0);
  ExpectBridged("right/0002.png", 2);
}

TEST_F(SpoiltImage, ThatIsTextIsBridged) {
  WriteTestFile(data_ / "left" / "0005.png", "no image\n");
  ExpectBridged("left/0005.png", 5);
}

// Its first and last bytes are as they should be.
TEST_F(SpoiltImage, ThatIsDamagedInTheMiddleIsBridged) {
  const fs::path image = data_ / "left" / "0004.png";
  std::fstream file(image, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(static_cast<std::streamoff>(fs::file_size(image) / 2));
  file << std::string(2000, '\x55');
  file.close();
  ExpectBridged("left/0004.png", 4);
  Succeeds(out_);  // from what is kept
  EXPECT_EQ(SummaryOf(out_)["health"]["unreadable_images"].size(), 1U);
}

TEST_F(SpoiltImage, AtTheEndsStillGivesEveryFrameAPose) {
  WriteTestFile(data_ / "left" / "0000.png", "no image\n");
  WriteTestFile(data_ / "right" / "0007.png", "no image\n");
  const ProgramEnd end = RunRigmap(Arguments(out_));
  EXPECT_TRUE(end.exit_code == 0 || end.exit_code == 3) << end.err;
  EXPECT_EQ(ReadTum(out_ / "trajectory.tum").size(), 8U);
}

TEST_F(SpoiltImage, LeavesNothingToDoWhenAllAreSpoilt) {
  for (int i = 0; i < 8; ++i) {
    WriteTestFile(data_ / "right" / ("000" + std::to_string(i) + ".png"), "no image\n");
  }
  EXPECT_THAT(Fails(out_), HasSubstr("none that can be read"));
  EXPECT_FALSE(fs::exists(out_));
}

// Grey and 16 bit say the same as their grey and 8 bit.
TEST_F(SpoiltImage, IsNoneOfGreyAndSixteenBit) {
  for (const std::string& name : FilesIn(data_)) {
    if (!name.ends_with(".png")) continue;
    const cv::Mat grey = cv::imread(data_ / name, cv::IMREAD_GRAYSCALE);
    ASSERT_TRUE(cv::imwrite(data_ / name, grey));
  }
  Succeeds(undisturbed_);
  for (const std::string& name : FilesIn(data_)) {
    if (!name.ends_with(".png")) continue;
    cv::Mat deep;
    cv::imread(data_ / name, cv::IMREAD_GRAYSCALE).convertTo(deep, CV_16U, 256.0);
    ASSERT_TRUE(cv::imwrite(data_ / name, deep));
  }
  Succeeds(out_);
  EXPECT_TRUE(ResultOf(out_) == ResultOf(undisturbed_));
}

// ---- COLMAP ----

class FailingColmap : public FaultTest {
 protected:
  // A run with a `colmap` that answers `help` as the real one does and makes true databases, but
  // does `deed` instead of mapping.
  std::string FailsWith(const std::string& deed, const std::vector<std::string>& more = {}) {
    return LastWord(
        RunWith("case \"$1\" in help|database_creator) exec " + Real() + " \"$@\";; esac\n" + deed,
                more),
        out_);
  }
  ProgramEnd RunWith(const std::string& script, const std::vector<std::string>& more = {}) {
    const fs::path program = folder_.Path() / "bin" / "colmap";
    fs::create_directories(program.parent_path());
    WriteTestFile(program, "#!/bin/sh\n" + script + "\n");
    fs::permissions(program, fs::perms::owner_all);
    std::vector<std::string> arguments{
        "PATH=" + program.parent_path().string() + ":" + std::getenv("PATH"), RIGMAP_PROGRAM};
    const auto rest = Arguments(out_, more);
    arguments.insert(arguments.end(), rest.begin(), rest.end());
    return RunProgram("env", arguments);
  }
  static std::string Real() {
    const std::string found = RunProgram("sh", {"-c", "command -v colmap"}).out;
    return found.substr(0, found.find('\n'));
  }
  void ExpectNothingMapped() {
    EXPECT_EQ(SummaryOf(out_)["status"], "failed");
    for (const char* name : {"trajectory.tum", "sparse", "dense.ply", "colmap/models"}) {
      EXPECT_FALSE(fs::exists(out_ / name)) << name;
    }
  }
};

TEST_F(FailingColmap, IsNamedWithItsEndAndTheNextRunIsAsIfNothingHadBeen) {
  EXPECT_THAT(FailsWith("echo out of luck; exit 9"),
              AllOf(HasSubstr("exit code 9"), HasSubstr("out of luck"), HasSubstr("mapping.log")));
  ExpectNothingMapped();
  EXPECT_THAT(FailsWith("kill -SEGV $$"), HasSubstr("SIGSEGV"));
  ExpectNothingMapped();
  EXPECT_THAT(FailsWith("kill -KILL $$"), HasSubstr("SIGKILL"));
  EXPECT_THAT(FailsWith("exit 0"), HasSubstr("expected a model"));
  EXPECT_THAT(FailsWith("printf 'bad \\377\\001 bytes\\n'; exit 1"), HasSubstr("bad"));
  ExpectNothingMapped();
  Succeeds(out_);
  Succeeds(undisturbed_);
  EXPECT_TRUE(ResultOf(out_) == ResultOf(undisturbed_));
}

TEST_F(FailingColmap, ThatHangsIsKilled) {
  EXPECT_THAT(FailsWith("exec sleep 1000", {"--set", "colmap.patience_s=0.5"}),
              HasSubstr("was killed after"));
  ExpectNothingMapped();
}

TEST_F(FailingColmap, ThatMakesNoDatabaseLeavesNone) {
  const std::string help = "if [ $1 = help ]; then exec " + Real() + " help; fi\n";
  EXPECT_THAT(LastWord(RunWith(help + "echo garbage > \"$3\""), out_), HasSubstr("database"));
  EXPECT_FALSE(fs::exists(out_ / "colmap" / "database.db"));
}

TEST_F(FailingColmap, OfAnotherVersionIsRefusedBeforeAnyWork) {
  EXPECT_THAT(LastWord(RunWith("echo COLMAP 3.9"), out_),
              AllOf(HasSubstr("expected COLMAP 3.8"), HasSubstr("found COLMAP 3.9")));
  EXPECT_FALSE(fs::exists(out_ / "stages"));
}

TEST_F(FaultTest, DatabaseThatIsLockedIsLeftAlone) {
  Succeeds(out_);
  const std::string before = ResultOf(out_);
  SQLite::Database other((out_ / "colmap" / "database.db").string(), SQLite::OPEN_READWRITE);
  other.exec("BEGIN EXCLUSIVE");
  for (const char* more : {"--from=database", "--from=features", "--force"}) {
    EXPECT_THAT(Fails(out_, {more}), AllOf(HasSubstr("database.db"), HasSubstr("locked"))) << more;
  }
  EXPECT_TRUE(ResultOf(out_) == before);
  other.exec("ROLLBACK");
  Succeeds(out_, {"--from=database"});
  EXPECT_TRUE(ResultOf(out_) == before);
}

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
