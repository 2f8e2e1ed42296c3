// What the built program says to a user who asks for something impossible.
#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>

#include "core/file.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_file.h"
#include "tests/workflows/rigmap_program.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

class CommandLine : public testing::Test {
 protected:
  // Runs `rigmap part` on the simulated part with more arguments; expects this exit code, nothing
  // on standard output, and returns the last line of standard error, which must be a sentence of
  // rigmap's own.
  std::string PartFails(int exit_code, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"part", "--dataset", SimulatedPartFolder(), "--out", out_};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Fails(exit_code, arguments);
  }
  std::string Fails(int exit_code, const std::vector<std::string>& arguments) {
    const ProgramEnd end = RunRigmap(arguments);
    EXPECT_EQ(end.exit_code, exit_code) << end.err;
    EXPECT_EQ(end.out, "");
    EXPECT_THAT(end.LastErrorLine(), StartsWith("rigmap: "));
    return end.LastErrorLine();
  }
  std::string DatasetFails(const fs::path& dataset) {
    return Fails(1, {"part", "--dataset", dataset, "--out", out_, "--until", "features"});
  }

  TemporaryFolder folder_;
  fs::path out_ = folder_.Path() / "out";
};

TEST_F(CommandLine, HelpAndVersionGoToStandardOutput) {
  const ProgramEnd help = RunRigmap({"part", "--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_EQ(help.err, "");
  for (const char* text : {"--dataset", "--until", "--from", "--set", "--truth", "--force",
                           "rigmap options", "voxel_m=0"}) {
    EXPECT_THAT(help.out, HasSubstr(text));
  }
  EXPECT_THAT(RunRigmap({"--version"}).out,
              ContainsRegex("^[0-9]+\\.[0-9]+\\.[0-9]+( \\(.+\\))?\n$"));
}

TEST_F(CommandLine, OptionsAreThoseOfTheDefaultFile) {
  const ProgramEnd options = RunRigmap({"options"});
  EXPECT_EQ(options.exit_code, 0);
  EXPECT_EQ(options.out, ReadTextFile(RIGMAP_CONFIG "/default.yaml"));
  EXPECT_THAT(RunRigmap({"options", "--format", "markdown"}).out, HasSubstr("\n## fusion\n"));
  EXPECT_THAT(Fails(2, {"options", "--format", "html"}), HasSubstr("yaml or markdown"));
}

TEST_F(CommandLine, WrongUsageEndsWithTwo) {
  EXPECT_THAT(Fails(2, {}), HasSubstr("subcommand"));
  EXPECT_THAT(Fails(2, {"map"}), HasSubstr("map"));
  EXPECT_THAT(Fails(2, {"part", "--out", out_}), HasSubstr("--dataset"));
  EXPECT_THAT(Fails(2, {"part", "--dataset", SimulatedPartFolder()}), HasSubstr("--out"));
  EXPECT_THAT(Fails(2, {"part", "--datset", SimulatedPartFolder(), "--out", out_}),
              HasSubstr("--datset: no such argument"));
  EXPECT_THAT(Fails(2, {"evaluate"}), HasSubstr("out"));
  EXPECT_THAT(PartFails(2, {"--voxel", "3"}), HasSubstr("--voxel"));
  EXPECT_THAT(PartFails(2, {"--rig", ""}), HasSubstr("--rig: expected a value, found ''"));
  EXPECT_THAT(Fails(2, {"part", "--dataset", SimulatedPartFolder(), "--out", ""}),
              HasSubstr("--out: expected a value, found ''"));
  EXPECT_THAT(PartFails(2, {"--threads", "many"}), HasSubstr("--threads"));
  EXPECT_THAT(PartFails(2, {"--threads", "0"}), HasSubstr("--threads"));
  EXPECT_THAT(PartFails(2, {"--memory", "1"}), HasSubstr("--memory"));
  EXPECT_THAT(PartFails(2, {"--accuracy", "0"}), HasSubstr("accuracy_pct"));
  EXPECT_THAT(PartFails(2, {"--accuracy", "inf"}),
              AllOf(HasSubstr("accuracy_pct"), HasSubstr("found inf")));
  EXPECT_THAT(PartFails(2, {"--format", "kitti"}), HasSubstr("--format"));
  EXPECT_FALSE(fs::exists(out_));
}

TEST_F(CommandLine, WrongFramesEndWithTwo) {
  for (const char* frames :
       {"5", "5:", ":5", "5:5", "6:2", "-1:4", "0:4x", "a:b", "0:4:8", "0:99999999999999999999"}) {
    EXPECT_THAT(PartFails(2, {std::string("--frames=") + frames}), HasSubstr("--frames"));
  }
  // As many as there are is the last that is right.
  EXPECT_THAT(PartFails(2, {"--frames", "0:9"}), HasSubstr("8"));
  EXPECT_FALSE(fs::exists(out_));
}

TEST_F(CommandLine, WrongStagesAndOptionsEndWithTwo) {
  EXPECT_THAT(PartFails(2, {"--until", "scaling"}), HasSubstr("'scaling'"));
  EXPECT_THAT(PartFails(2, {"--from", "scaling"}), HasSubstr("adjustment"));
  EXPECT_THAT(PartFails(2, {"--from", "dense", "--until", "scale"}), HasSubstr("--until scale"));
  EXPECT_THAT(PartFails(2, {"--set", "fusion.voxle_m=0.02"}), HasSubstr("voxel_m"));
  EXPECT_THAT(PartFails(2, {"--set", "fusion.voxel_m=-1"}), HasSubstr("fusion.voxel_m"));
  EXPECT_THAT(PartFails(2, {"--set", "fusion"}), HasSubstr("stage.option=value"));
  EXPECT_FALSE(fs::exists(out_));
}

TEST_F(CommandLine, KatwijkPartsOfAStereoFolderEndWithTwo) {
  EXPECT_THAT(PartFails(2, {"--part", "2"}), HasSubstr("--part"));
}

TEST_F(CommandLine, ConfigurationThatCannotBeUsedEndsWithOne) {
  const auto config = WriteTestFile(folder_.Path() / "my.yaml", "fusion:\n  voxle_m: 1\n");
  EXPECT_THAT(PartFails(1, {"--config", config}), HasSubstr("my.yaml:2"));
  EXPECT_THAT(PartFails(1, {"--config", folder_.Path() / "no.yaml"}), HasSubstr("no.yaml"));
  EXPECT_FALSE(fs::exists(out_));
}

TEST_F(CommandLine, MissingDataEndsWithOne) {
  EXPECT_THAT(DatasetFails(folder_.Path() / "nowhere"), HasSubstr("nowhere"));
  EXPECT_THAT(DatasetFails(SimulatedPartFolder() / "times.txt"), HasSubstr("a file"));
  fs::create_directories(folder_.Path() / "empty");
  EXPECT_THAT(DatasetFails(folder_.Path() / "empty"), HasSubstr("stereo folder"));
  EXPECT_THAT(PartFails(1, {"--rig", folder_.Path() / "no.yaml"}), HasSubstr("no.yaml"));
  EXPECT_FALSE(fs::exists(out_));
}

TEST_F(CommandLine, TruthThatCannotBeReadEndsWithOneBeforeAnyWork) {
  EXPECT_THAT(PartFails(1, {"--truth", folder_.Path() / "no.tum"}), HasSubstr("no.tum"));
  fs::create_directories(folder_.Path() / "truth");
  EXPECT_THAT(PartFails(1, {"--truth", folder_.Path() / "truth"}), HasSubstr("trajectory.tum"));
  const auto text = WriteTestFile(folder_.Path() / "text.tum", "no pose at all\n");
  EXPECT_THAT(PartFails(1, {"--truth", text}), HasSubstr("text.tum:1"));
  EXPECT_FALSE(fs::exists(out_));
}

TEST_F(CommandLine, FolderOfSomethingElseIsRefusedAndLeftAsItIs) {
  fs::create_directories(out_);
  WriteTestFile(out_ / "thesis.tex", "mine\n");
  EXPECT_THAT(PartFails(1, {}), HasSubstr("not empty"));
  EXPECT_THAT(FilesIn(out_), ElementsAre("thesis.tex"));
}

TEST_F(CommandLine, OutputOverTheInputIsRefusedEvenByForce) {
  const fs::path data = CopyOfSimulatedPart(folder_.Path());
  const auto before = FilesIn(folder_.Path());
  for (const fs::path& out : {data, folder_.Path(), data / "left"}) {
    EXPECT_THAT(Fails(1, {"part", "--dataset", data, "--out", out, "--force"}),
                HasSubstr("holds the input"));
  }
  EXPECT_THAT(Fails(1, {"part", "--dataset", data, "--out", data / "left" / "out"}),
              HasSubstr("among the images"));
  EXPECT_EQ(FilesIn(folder_.Path()), before);
}

TEST_F(CommandLine, OutputThatCannotBeWrittenEndsWithOne) {
  EXPECT_THAT(Fails(1, {"part", "--dataset", SimulatedPartFolder(), "--out", "/proc/out"}),
              HasSubstr("/proc/out"));
  const auto file = WriteTestFile(folder_.Path() / "file", "mine\n");
  EXPECT_THAT(Fails(1, {"part", "--dataset", SimulatedPartFolder(), "--out", file}),
              HasSubstr("a file"));
}

TEST_F(CommandLine, SaysHowARunEndedUnlessQuiet) {
  std::vector<std::string> part{"part",    "--dataset", SimulatedPartFolder(), "--out", out_,
                                "--until", "dataset"};
  EXPECT_THAT(RunRigmap(part).err,
              testing::EndsWith("rigmap: done up to dataset, no gate checked yet; results in " +
                                out_.string() + "\n"));
  part.push_back("--quiet");
  EXPECT_THAT(RunRigmap(part).err, testing::IsEmpty());
}

TEST_F(CommandLine, ForceDoesNotRemoveWhatRigmapDidNotWrite) {
  fs::create_directories(out_);
  WriteTestFile(out_ / "thesis.tex", "mine\n");
  EXPECT_THAT(PartFails(1, {"--force"}), HasSubstr("not empty"));
  ASSERT_EQ(RunRigmap({"part", "--dataset", SimulatedPartFolder(), "--out", folder_.Path() / "mine",
                       "--until", "dataset"})
                .exit_code,
            0);
  out_ = folder_.Path() / "mine";
  WriteTestFile(out_ / "notes.txt", "mine\n");
  EXPECT_THAT(PartFails(1, {"--force"}), HasSubstr("notes.txt"));
  EXPECT_EQ(ReadTextFile(out_ / "notes.txt"), "mine\n");
  EXPECT_TRUE(fs::exists(out_ / "summary.json"));
}

TEST_F(CommandLine, FolderOnceUsedIsNotTakenForOtherData) {
  ASSERT_EQ(
      RunRigmap({"part", "--dataset", SimulatedPartFolder(), "--out", out_, "--until", "dataset"})
          .exit_code,
      0);
  const fs::path data = CopyOfSimulatedPart(folder_.Path());
  // The same data at another place are no other data.
  EXPECT_EQ(RunRigmap({"part", "--dataset", data, "--out", out_, "--until", "dataset"}).exit_code,
            0);
  fs::copy_file(data / "left" / "0001.png", data / "left" / "0000.png",
                fs::copy_options::overwrite_existing);
  EXPECT_THAT(DatasetFails(data), AllOf(HasSubstr("8 pairs"), HasSubstr("--force")));
  EXPECT_THAT(PartFails(1, {"--frames", "0:4"}), AllOf(HasSubstr("4 pairs"), HasSubstr("--force")));
  EXPECT_EQ(RunRigmap({"part", "--dataset", data, "--out", out_, "--until", "dataset", "--force"})
                .exit_code,
            0);
}

class SpoiltFolder : public CommandLine {
 protected:
  SpoiltFolder() : data_(CopyOfSimulatedPart(folder_.Path())) {}
  fs::path data_;
};

TEST_F(SpoiltFolder, WithoutRightImagesIsRefused) {
  fs::remove_all(data_ / "right");
  EXPECT_THAT(DatasetFails(data_), HasSubstr("8 and 0"));
}

TEST_F(SpoiltFolder, WithoutCalibrationIsRefused) {
  fs::remove(data_ / "calib.yaml");
  EXPECT_THAT(DatasetFails(data_), HasSubstr("calib.yaml"));
}

TEST_F(SpoiltFolder, WithAnImageMissingIsRefused) {
  fs::remove(data_ / "right" / "0004.png");
  EXPECT_THAT(DatasetFails(data_), HasSubstr("8 and 7"));
}

TEST_F(SpoiltFolder, WithImagesOfAnotherSizeIsRefused) {
  cv::imwrite((data_ / "left" / "0000.png").string(), cv::Mat(200, 300, CV_8UC1, cv::Scalar(7)));
  const std::string message = DatasetFails(data_);
  EXPECT_THAT(message, HasSubstr("0000.png"));
  EXPECT_THAT(message, HasSubstr("300 x 200"));
}

TEST_F(SpoiltFolder, WithALaterImageOfAnotherSizeIsRefused) {
  cv::imwrite((data_ / "right" / "0005.png").string(), cv::Mat(200, 300, CV_8UC1, cv::Scalar(7)));
  const std::string message = DatasetFails(data_);
  EXPECT_THAT(message, HasSubstr("right/0005.png"));
  EXPECT_THAT(message, HasSubstr("320 x 240"));
  EXPECT_THAT(message, HasSubstr("300 x 200"));
  EXPECT_FALSE(fs::exists(out_));
}

TEST_F(SpoiltFolder, WithBrokenTimesIsRefused) {
  WriteTestFile(data_ / "times.txt", "1\n2\n3\n3\n5\n6\n7\n8\n");
  EXPECT_THAT(DatasetFails(data_), HasSubstr("times.txt:4"));
}

TEST_F(SpoiltFolder, WithTimesThatAreNoNumbersIsRefusedInLegibleWords) {
  using namespace std::string_literals;
  for (const auto& [line, found] : {std::pair("soon"s, "found 'soon'"),
                                    {"nan"s, "found 'nan'"},
                                    {"inf"s, "found 'inf'"},
                                    {"3\0"s, "found '3\\x00'"},
                                    {"\0\0\0\0"s, "found '\\x00\\x00\\x00\\x00'"},
                                    {"3\x1b[2J"s, "found '3\\x1b[2J'"}}) {
    WriteTestFile(data_ / "times.txt", "1\n2\n" + line + "\n4\n5\n6\n7\n8\n");
    EXPECT_THAT(DatasetFails(data_),
                AllOf(HasSubstr("times.txt:3"), HasSubstr("expected a time"), HasSubstr(found)));
  }
  WriteTestFile(data_ / "times.txt", std::string(1 << 20, '\0'));
  EXPECT_LT(DatasetFails(data_).size(), 4200U);
  EXPECT_FALSE(fs::exists(out_));
}

TEST_F(SpoiltFolder, WithACalibrationThatIsNoneIsRefused) {
  const std::string right = ReadTextFile(data_ / "calib.yaml");
  struct Case {
    const char *instead_of, *by, *expected;
  };
  for (const Case& spoilt : {Case{"distortion:", "distorsion:", "distorsion"},
                             {"  model: OPENCV", "  model: FISHEYE", "FISHEYE"},
                             {"fx: 26", "fx: nan # ", "finite number, found 'nan'"},
                             {"fx: 26", "fx: -26", "positive focal length, found -260"},
                             {"R: [", "R: [7, 7, 7, 7, 7, 7, 7, 7, 7] # ", "R"},
                             {"t: [", "t: [.inf, 0, 0] # ", "t"},
                             {"0, 0]", "0, 0, 0.01]", "k3"}}) {
    std::string text = right;
    const auto at = text.find(spoilt.instead_of);
    ASSERT_NE(at, std::string::npos) << spoilt.instead_of;
    WriteTestFile(data_ / "calib.yaml",
                  text.replace(at, std::string(spoilt.instead_of).size(), spoilt.by));
    EXPECT_THAT(DatasetFails(data_), AllOf(ContainsRegex("calib.yaml:[0-9]+"),
                                           HasSubstr("expected"), HasSubstr(spoilt.expected)))
        << spoilt.by;
  }
  EXPECT_FALSE(fs::exists(out_));
}

// Without a rig file of its own, data in Katwijk's form is taken with that of the program.
TEST_F(SpoiltFolder, InKatwijksFormIsReadWithTheProgramsOwnRig) {
  fs::create_directories(folder_.Path() / "katwijk" / "Part1" / "LocCam");
  for (const char* eye : {"left", "right"}) {
    const std::string name =
        std::string("LocCam_2015_11_26_15_23_36_619_") + (eye[0] == 'l' ? "0.png" : "1.png");
    fs::copy(data_ / eye / "0000.png", folder_.Path() / "katwijk" / "Part1" / "LocCam" / name);
  }
  const std::string message = DatasetFails(folder_.Path() / "katwijk");
  EXPECT_THAT(message, HasSubstr("1024 x 768"));
  EXPECT_THAT(message, HasSubstr("config/rigs/loccam.yaml"));
}

}  // namespace
}  // namespace rigmap
