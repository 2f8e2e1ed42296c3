#include "workflows/output_folder.h"

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>

#include "core/error.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_file.h"
#include "tests/workflows/rigmap_program.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class OutputFolder : public testing::Test {
 protected:
  // Takes the folder as a run does, and lets it go.
  void Take(const std::string& frames, bool force = false) {
    const FolderMark mark{frames, frames + " in words"};
    RequireOwnOutput(root_, mark, force);
    const OutputLock lock(root_);
    ClaimOutput(root_, mark, force);
  }
  std::string Refusal(const std::string& frames, bool force = false) {
    try {
      Take(frames, force);
    } catch (const DataError& error) {
      return error.what();
    }
    return "taken";
  }
  fs::path WriteInside(const std::string& name) {
    fs::create_directories((root_ / name).parent_path());
    return WriteTestFile(root_ / name, "mine\n");
  }

  TemporaryFolder folder_;
  fs::path root_ = folder_.Path() / "a" / "out";
};

TEST_F(OutputFolder, IsMadeWithItsParents) {
  Take("these");
  EXPECT_TRUE(fs::is_directory(root_));
}

TEST_F(OutputFolder, IsTakenAgainForTheSameDataAndKeepsWhatIsThere) {
  Take("these");
  const auto file = WriteInside("stages/features.bin");
  Take("these");
  EXPECT_TRUE(fs::exists(file));
}

TEST_F(OutputFolder, IsHeldByOneAtATime) {
  std::optional<OutputLock> first(std::in_place, root_);
  try {
    OutputLock second(root_);
    ADD_FAILURE() << "two hold it";
  } catch (const DataError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr(root_.string()), HasSubstr("another")));
  }
  first.reset();
  OutputLock again(root_);
}

TEST_F(OutputFolder, IsHeldAgainstAnotherProcess) {
  const OutputLock lock(root_);
  const pid_t child = fork();
  if (child == 0) {
    try {
      OutputLock second(root_);
      _exit(0);
    } catch (const DataError&) {
      _exit(42);
    }
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 42);
}

TEST_F(OutputFolder, IsNotHeldByProgramsThatWereStartedMeanwhile) {
  std::optional<OutputLock> lock(std::in_place, root_);
  const pid_t child = fork();
  if (child == 0) {
    execlp("sleep", "sleep", "30", nullptr);
    _exit(127);
  }
  // Until it has become the other program it shares the lock.
  const auto name = "/proc/" + std::to_string(child) + "/comm";
  for (std::string comm; comm != "sleep"; std::ifstream(name) >> comm) usleep(1000);
  lock.reset();
  EXPECT_NO_THROW(OutputLock{root_});
  KillHard(child);
}

TEST_F(OutputFolder, ThatHoldsSomethingElseIsRefusedAndLeftAsItIs) {
  WriteInside("thesis.tex");
  for (const bool force : {false, true}) {
    EXPECT_THAT(Refusal("these", force), AllOf(HasSubstr(root_.string()), HasSubstr("not empty")));
    EXPECT_THAT(FilesIn(root_), ElementsAre("thesis.tex"));
  }
}

TEST_F(OutputFolder, OfOtherFramesIsRefusedAndLeftAsItIs) {
  Take("these");
  const auto before = FilesIn(root_);
  EXPECT_THAT(Refusal("others"), AllOf(HasSubstr("these in words"), HasSubstr("others in words"),
                                       HasSubstr("--force")));
  EXPECT_EQ(FilesIn(root_), before);
  EXPECT_EQ(Refusal("these"), "taken");
}

TEST_F(OutputFolder, OfAnOlderRigmapIsRefusedAndEmptiedByForce) {
  WriteInside(".dataset");
  WriteInside("trajectory.tum");
  EXPECT_THAT(Refusal("these"), HasSubstr("older rigmap"));
  EXPECT_EQ(Refusal("these", true), "taken");
  EXPECT_FALSE(fs::exists(root_ / "trajectory.tum"));
}

TEST_F(OutputFolder, IsEmptiedByForceOfWhatRigmapWrote) {
  Take("these");
  for (const char* name : {"dense.ply", "stages/dense/1.bin", "logs/dense.log", "summary.json",
                           "colmap/models/0/images.bin", "sparse.ply.unfinished"}) {
    WriteInside(name);
  }
  Take("others", true);
  for (const auto& name : FilesIn(root_)) EXPECT_EQ(name.front(), '.') << name;
  EXPECT_EQ(Refusal("others"), "taken");
}

TEST_F(OutputFolder, IsNotEmptiedOfWhatRigmapDidNotWrite) {
  Take("these");
  WriteInside("dense.ply");
  WriteInside("notes/today.txt");
  const auto before = FilesIn(root_);
  EXPECT_THAT(Refusal("others", true), HasSubstr("notes"));
  EXPECT_EQ(FilesIn(root_), before);
}

TEST_F(OutputFolder, IsNeverAHomeOrTheRoot) {
  Take("these");
  const char* home = std::getenv("HOME");
  const std::string before = home ? home : "";
  setenv("HOME", root_.c_str(), 1);
  EXPECT_THAT(Refusal("these", true), HasSubstr("home"));
  EXPECT_THAT(Refusal("these"), HasSubstr("home"));
  setenv("HOME", before.c_str(), 1);
  EXPECT_EQ(Refusal("these"), "taken");
  root_ = "/";
  EXPECT_THAT(Refusal("these", true), HasSubstr("root"));
}

TEST_F(OutputFolder, ThatWasBeingClaimedWhenTheProcessDiedIsTaken) {
  Take("these");
  fs::rename(root_ / ".dataset", root_ / ".dataset.unfinished");
  EXPECT_EQ(Refusal("these"), "taken");
}

TEST_F(OutputFolder, ThatIsAFileIsRefused) {
  fs::create_directories(root_.parent_path());
  WriteTestFile(root_, "mine\n");
  EXPECT_THAT(Refusal("these"), AllOf(HasSubstr(root_.string()), HasSubstr("a file")));
}

TEST_F(OutputFolder, ThatCannotBeWrittenIsRefused) {
  // No user, not even root, can make a folder there.
  root_ = "/proc/rigmap-out";
  EXPECT_THAT(Refusal("these"), AllOf(HasSubstr("/proc/rigmap-out"), HasSubstr("cannot write")));
}

TEST_F(OutputFolder, ThatHoldsTheInputIsRefused) {
  Dataset dataset;
  dataset.frames = {{1, WriteInside("left/1.png"), WriteInside("right/1.png")}};
  const auto refusal = [&](const fs::path& out) -> std::string {
    try {
      RequireInputElsewhere(out, dataset);
    } catch (const DataError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(refusal(root_), HasSubstr("left/1.png"));
  EXPECT_THAT(refusal(root_.parent_path()), HasSubstr("left/1.png"));
  EXPECT_THAT(refusal(root_ / "right"), HasSubstr("right/1.png"));
  EXPECT_THAT(refusal(root_ / "left" / ".." / "right" / "."), HasSubstr("right/1.png"));
  EXPECT_THAT(refusal(root_ / "left" / "out"), HasSubstr("among the images"));
  EXPECT_THAT(refusal(root_ / "out"), IsEmpty());
  EXPECT_THAT(refusal(root_.parent_path() / "out2"), IsEmpty());
  const fs::path link = folder_.Path() / "link";
  fs::create_directory_symlink(root_, link);
  EXPECT_THAT(refusal(link), HasSubstr("left/1.png"));
}

TEST_F(OutputFolder, OfAJoinIsApartFromThePartsButForATraversesOwn) {
  const auto refusal = [&](const fs::path& out, const fs::path& part) {
    return MessageOf<DataError>([&] { RequirePartsElsewhere(out, {part}); });
  };
  EXPECT_THAT(refusal(root_, root_), HasSubstr("expected an output folder apart from the parts"));
  EXPECT_THAT(refusal(root_ / "whole", root_), HasSubstr("found it in " + root_.string()));
  EXPECT_THAT(refusal(root_, root_ / "first"), HasSubstr("found " + (root_ / "first").string()));
  EXPECT_NO_THROW(RequirePartsElsewhere(root_, {root_ / "parts" / "first"}));
  EXPECT_NO_THROW(RequirePartsElsewhere(root_, {folder_.Path() / "a" / "out-1"}));
}

}  // namespace
}  // namespace rigmap
