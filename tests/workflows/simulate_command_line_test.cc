// What the built simulator says to a user, and what it leaves alone.
#include <gmock/gmock.h>

#include "core/file.h"
#include "dataset/rig_file.h"
#include "tests/support/simulated_part.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_file.h"
#include "tests/workflows/rigmap_program.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::StartsWith;

class SimulateCommandLine : public testing::Test {
 protected:
  SimulateCommandLine() {
    StereoRig rig = SmallRoverRig();
    for (RigEye* eye : {&rig.left, &rig.right}) {
      eye->camera.width = eye->camera.height = 40;
      eye->camera.fx = eye->camera.fy = 40.0;
      eye->camera.cx = eye->camera.cy = 19.5;
    }
    WriteTestFile(rig_, WriteRigFile(rig));
  }

  // Later options replace earlier ones where they are the same.
  ProgramEnd Run(const std::vector<std::string>& more, const fs::path& folder = ".") const {
    std::vector<std::string> arguments{"--scene", "flat-sand", "--path", "straight"};
    for (const char* argument : {"--pairs", "3", "--spacing", "0.2", "--seed", "1", "--quiet"}) {
      arguments.emplace_back(argument);
    }
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunProgram(RIGMAP_SIMULATE_PROGRAM, arguments, folder);
  }
  ProgramEnd RunSmall(const fs::path& out, std::vector<std::string> more = {}) const {
    more.insert(more.end(), {"--rig", rig_, "--out", out});
    return Run(more);
  }
  static std::string Sentence(const ProgramEnd& end, int exit_code) {
    EXPECT_EQ(end.exit_code, exit_code) << end.err;
    EXPECT_EQ(end.out, "");
    EXPECT_THAT(end.LastErrorLine(), StartsWith("rigmap-simulate: "));
    return end.LastErrorLine();
  }
  // Of a whole command line.
  static std::string Fails(int exit_code, const std::vector<std::string>& arguments) {
    return Sentence(RunProgram(RIGMAP_SIMULATE_PROGRAM, arguments), exit_code);
  }
  std::vector<std::string> With(const std::string& option, const std::string& value) const {
    std::vector<std::string> arguments;
    for (const auto& [name, usual] : {std::pair<std::string, std::string>{"--scene", "beach"},
                                      {"--path", "loop"},
                                      {"--pairs", "40"},
                                      {"--spacing", "0.2"},
                                      {"--seed", "1"},
                                      {"--out", out_}}) {
      arguments.insert(arguments.end(), {name, name == option ? value : usual});
    }
    return arguments;
  }

  TemporaryFolder folder_;
  fs::path out_ = folder_.Path() / "out", rig_ = folder_.Path() / "small.yaml";
};

TEST_F(SimulateCommandLine, HelpNamesScenesPathsAndFaults) {
  const ProgramEnd help = RunProgram(RIGMAP_SIMULATE_PROGRAM, {"--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_EQ(help.err, "");
  for (const char* word : {"flat-sand", "u-turn", "lone-left", "--force", "--fault"}) {
    EXPECT_THAT(help.out, HasSubstr(word));
  }
}

TEST_F(SimulateCommandLine, WrongUsageEndsWithTwo) {
  EXPECT_THAT(Fails(2, {}), HasSubstr("required"));
  EXPECT_THAT(Fails(2, With("--scene", "moon")),
              HasSubstr("beach, flat-sand, rocks, found 'moon'"));
  EXPECT_THAT(Fails(2, With("--path", "spiral")), HasSubstr("spiral"));
  EXPECT_THAT(Fails(2, With("--pairs", "2")), HasSubstr("3 to 20000"));
  EXPECT_THAT(Fails(2, With("--pairs", "many")), HasSubstr("--pairs"));
  EXPECT_THAT(Fails(2, With("--spacing", "-1")), HasSubstr("spacing"));
  EXPECT_THAT(Fails(2, With("--seed", "x")), HasSubstr("--seed"));
  EXPECT_THAT(Fails(2, With("--seed", "-1")), HasSubstr("expected a whole number of 0 or more"));
  for (const auto& [more, words] : {std::pair{std::vector<std::string>{"--fault", "fog=1"}, "fog"},
                                    {{"--fault", "dropped=99"}, "dropped"},
                                    {{"--fault", "dropped"}, "dropped"},
                                    {{"--threads", "0"}, "--threads"},
                                    {{"--traverse", "4"}, "1, 2 or 3"},
                                    {{"--voxel", "3"}, "--voxel"}}) {
    auto arguments = With("", "");
    arguments.insert(arguments.end(), more.begin(), more.end());
    EXPECT_THAT(Fails(2, arguments), HasSubstr(words));
  }
  EXPECT_EQ(FilesIn(folder_.Path()), std::vector<std::string>{"small.yaml"});
}

TEST_F(SimulateCommandLine, RigThatCannotBeReadEndsWithOne) {
  EXPECT_THAT(Sentence(Run({"--rig", folder_.Path() / "no.yaml", "--out", out_}), 1),
              HasSubstr("no.yaml"));
  const auto broken = WriteTestFile(folder_.Path() / "broken.yaml", "left: [1, 2\n");
  EXPECT_THAT(Sentence(Run({"--rig", broken, "--out", out_}), 1), HasSubstr("broken.yaml"));
  EXPECT_FALSE(fs::exists(out_));
}

TEST_F(SimulateCommandLine, FillsAnEmptyFolderAndReplacesAFullOneByForceOnly) {
  fs::create_directory(out_);
  const ProgramEnd first = Run({"--out", out_});
  EXPECT_EQ(first.exit_code, 0);
  EXPECT_EQ(first.out + first.err, "");
  EXPECT_TRUE(fs::exists(out_ / "truth" / "Part1" / "trajectory.tum"));
  EXPECT_EQ(ReadRigFile(out_ / "data" / "rig.yaml").left.camera.width, 1024);  // LocCam
  EXPECT_THAT(Sentence(RunSmall(out_), 1), HasSubstr("--force"));
  EXPECT_EQ(RunSmall(out_, {"--force"}).exit_code, 0);
  EXPECT_EQ(ReadRigFile(out_ / "data" / "rig.yaml").left.camera.width, 40);
  EXPECT_EQ(FilesIn(folder_.Path()).size(), FilesIn(out_).size() + 2);  // nothing left beside
}

TEST_F(SimulateCommandLine, TakesAwayNothingThatItDidNotWrite) {
  EXPECT_EQ(RunSmall(out_).exit_code, 0);
  const auto mine = WriteTestFile(out_ / "mine.txt", "mine\n");
  EXPECT_THAT(Sentence(RunSmall(out_, {"--force"}), 1), HasSubstr("found mine.txt"));
  EXPECT_EQ(ReadTextFile(mine), "mine\n");
  const fs::path other = folder_.Path() / "other";
  fs::create_directories(other / "data");
  const auto theirs = WriteTestFile(other / "data" / "theirs.txt", "theirs\n");
  EXPECT_THAT(Sentence(RunSmall(other, {"--force"}), 1), HasSubstr("found no rig files"));
  EXPECT_EQ(ReadTextFile(theirs), "theirs\n");
  fs::create_directory(folder_.Path() / "new.unfinished");
  const auto beside = WriteTestFile(folder_.Path() / "new.unfinished" / "notes.txt", "notes\n");
  EXPECT_THAT(Sentence(RunSmall(folder_.Path() / "new"), 1), HasSubstr("found notes.txt"));
  EXPECT_EQ(ReadTextFile(beside), "notes\n");
}

TEST_F(SimulateCommandLine, FileInTheWayEndsWithOneWithoutForce) {
  const auto file = WriteTestFile(folder_.Path() / "file", "mine\n");
  EXPECT_THAT(Sentence(RunSmall(file), 1), HasSubstr("found a file"));
  EXPECT_EQ(ReadTextFile(file), "mine\n");
}

TEST_F(SimulateCommandLine, FolderMayBeNamedWithASlashBehind) {
  const ProgramEnd end = RunSmall(out_ / "");
  EXPECT_EQ(end.exit_code, 0) << end.err;
  EXPECT_TRUE(fs::exists(out_ / "data" / "rig.yaml"));
}

}  // namespace
}  // namespace rigmap
