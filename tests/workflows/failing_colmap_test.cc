// What happens to a part when COLMAP fails.
#include <SQLiteCpp/SQLiteCpp.h>

#include <cstdlib>

#include "tests/support/test_file.h"
#include "tests/workflows/faulty_run.h"

namespace rigmap {
namespace {

using testing::AllOf;
using testing::HasSubstr;

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

// Its triangulator is another way, which `rig` takes; the technique that is nothing but its mapping
// takes none.
TEST_F(FailingColmap, WhoseMapperAloneGivesUpIsAnErrorWhereItsMappingIsAskedFor) {
  const std::string script = "[ \"$1\" = mapper ] && exit 1\nexec " + Real() + " \"$@\"";
  EXPECT_EQ(RunWith(script, {"--until", "adjustment"}).exit_code, 0);
  const ProgramEnd end = RunWith(script, {"--technique", "colmap", "--until", "trajectory"});
  EXPECT_EQ(end.exit_code, 1);
  EXPECT_THAT(end.LastErrorLine(), HasSubstr("expected a model of COLMAP's mapping (seeded), found "
                                             "none: "));
}

TEST_F(FailingColmap, ThatHangsIsKilled) {
  EXPECT_THAT(FailsWith("exec sleep 1000", {"--set", "colmap.patience_s=0.5"}),
              HasSubstr("was killed after"));
  ExpectNothingMapped();
}

// A script that starts the real one as a child of its own works as well.
TEST_F(FailingColmap, IsNotAWrapperThatStaysBetween) {
  const std::string script = Real() + " \"$@\"\nend=$?\nexit $end";
  const ProgramEnd end = RunWith(script);
  EXPECT_EQ(end.exit_code, 0) << end.err;
  Succeeds(undisturbed_);
  EXPECT_TRUE(ResultOf(out_) == ResultOf(undisturbed_));
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

}  // namespace
}  // namespace rigmap
