#include "workflows/output_folder.h"

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/error.h"
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
  void Take(const std::string& identity, bool force = false) {
    RequireOwnOutput(layout_, identity, force);
    const OutputLock lock(layout_.root);
    ClaimOutput(layout_, identity, force);
  }
  std::string Refusal(const std::string& identity) {
    try {
      Take(identity);
    } catch (const DataError& error) {
      return error.what();
    }
    return "taken";
  }
  fs::path WriteInside(const std::string& name) {
    fs::create_directories((layout_.root / name).parent_path());
    return WriteTestFile(layout_.root / name, "mine\n");
  }

  TemporaryFolder folder_;
  OutputLayout layout_{folder_.Path() / "a" / "out"};
};

TEST_F(OutputFolder, IsMadeWithItsParents) {
  Take("/data/left");
  EXPECT_TRUE(fs::is_directory(layout_.root));
}

TEST_F(OutputFolder, IsTakenAgainForTheSameDataAndKeepsWhatIsThere) {
  Take("/data/left");
  const auto file = WriteInside("stages/features.bin");
  Take("/data/left");
  EXPECT_TRUE(fs::exists(file));
}

TEST_F(OutputFolder, IsHeldByOneAtATime) {
  std::optional<OutputLock> first(std::in_place, layout_.root);
  try {
    OutputLock second(layout_.root);
    ADD_FAILURE() << "two hold it";
  } catch (const DataError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr(layout_.root.string()), HasSubstr("another")));
  }
  first.reset();
  OutputLock again(layout_.root);
}

TEST_F(OutputFolder, IsHeldAgainstAnotherProcess) {
  const OutputLock lock(layout_.root);
  const pid_t child = fork();
  if (child == 0) {
    try {
      OutputLock second(layout_.root);
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
  std::optional<OutputLock> lock(std::in_place, layout_.root);
  const pid_t child = fork();
  if (child == 0) {
    execlp("sleep", "sleep", "30", nullptr);
    _exit(127);
  }
  // Until it has become the other program it shares the lock.
  const auto name = "/proc/" + std::to_string(child) + "/comm";
  for (std::string comm; comm != "sleep"; std::ifstream(name) >> comm) usleep(1000);
  lock.reset();
  EXPECT_NO_THROW(OutputLock{layout_.root});
  KillHard(child);
}

TEST_F(OutputFolder, ThatHoldsSomethingElseIsRefusedAndLeftAsItIs) {
  WriteInside("thesis.tex");
  EXPECT_THAT(Refusal("/data/left"), AllOf(HasSubstr(layout_.root.string()), HasSubstr("not empty"),
                                           HasSubstr("--force")));
  EXPECT_THAT(FilesIn(layout_.root), ElementsAre("thesis.tex"));
}

TEST_F(OutputFolder, OfOtherDataIsRefusedAndLeftAsItIs) {
  Take("/data/left");
  const auto before = FilesIn(layout_.root);
  EXPECT_THAT(Refusal("/other/left"),
              AllOf(HasSubstr("/data/left"), HasSubstr("/other/left"), HasSubstr("--force")));
  EXPECT_EQ(FilesIn(layout_.root), before);
  EXPECT_EQ(Refusal("/data/left"), "taken");
}

TEST_F(OutputFolder, IsEmptiedByForce) {
  WriteInside("thesis.tex");
  WriteInside("deep/er/file");
  Take("/data/left", true);
  for (const auto& name : FilesIn(layout_.root)) EXPECT_EQ(name.front(), '.') << name;
  EXPECT_EQ(Refusal("/data/left"), "taken");
}

TEST_F(OutputFolder, ThatWasBeingClaimedWhenTheProcessDiedIsTaken) {
  Take("/data/left");
  fs::rename(layout_.root / ".dataset", layout_.root / ".dataset.unfinished");
  EXPECT_EQ(Refusal("/data/left"), "taken");
}

TEST_F(OutputFolder, ThatIsAFileIsRefused) {
  fs::create_directories(layout_.root.parent_path());
  WriteTestFile(layout_.root, "mine\n");
  EXPECT_THAT(Refusal("/data/left"), AllOf(HasSubstr(layout_.root.string()), HasSubstr("a file")));
}

TEST_F(OutputFolder, ThatCannotBeWrittenIsRefused) {
  // No user, not even root, can make a folder there.
  layout_.root = "/proc/rigmap-out";
  EXPECT_THAT(Refusal("/data/left"),
              AllOf(HasSubstr("/proc/rigmap-out"), HasSubstr("cannot write")));
}

TEST_F(OutputFolder, ThatHoldsTheInputIsRefused) {
  Dataset dataset;
  dataset.frames = {{1, WriteInside("left/1.png"), WriteInside("right/1.png")}};
  const auto refusal = [&](const fs::path& out) -> std::string {
    try {
      RequireInputElsewhere({out}, dataset);
    } catch (const DataError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(refusal(layout_.root), HasSubstr("left/1.png"));
  EXPECT_THAT(refusal(layout_.root.parent_path()), HasSubstr("left/1.png"));
  EXPECT_THAT(refusal(layout_.root / "right"), HasSubstr("right/1.png"));
  EXPECT_THAT(refusal(layout_.root / "left" / ".." / "right" / "."), HasSubstr("right/1.png"));
  EXPECT_THAT(refusal(layout_.root / "out"), IsEmpty());
  EXPECT_THAT(refusal(layout_.root.parent_path() / "out2"), IsEmpty());
  const fs::path link = folder_.Path() / "link";
  fs::create_directory_symlink(layout_.root, link);
  EXPECT_THAT(refusal(link), HasSubstr("left/1.png"));
}

}  // namespace
}  // namespace rigmap
