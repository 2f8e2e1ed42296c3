// `rigmap compare` on the simulated part.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_file.h"
#include "tests/workflows/rigmap_program.h"
#include "workflows/comparison_runs.h"
#include "workflows/output_folder.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;
using testing::StartsWith;

class CompareTest : public testing::Test {
 protected:
  ProgramEnd Compare(const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"compare",
                                       "--dataset",
                                       SimulatedPartFolder(),
                                       "--truth",
                                       SimulatedPartFolder() / "groundtruth_tum.txt",
                                       "--out",
                                       out_,
                                       "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunRigmap(arguments);
  }
  json Rows() const { return json::parse(ReadTextFile(out_ / "comparison.json"))["rows"]; }

  TemporaryFolder folder_;
  fs::path out_ = folder_.Path() / "comparison";
};

TEST_F(CompareTest, SetsTechniquesAndSettingsSideBySideAndGoesOnFromWhatIsThere) {
  const ProgramEnd vo = Compare({"--techniques", "vo"});
  ASSERT_EQ(vo.exit_code, 0) << vo.err;
  EXPECT_THAT(vo.out, testing::StartsWith("part"));
  ASSERT_EQ(Rows().size(), 1U);
  const double seconds = Rows()[0]["seconds"];
  EXPECT_LT(Rows()[0]["ate_se3_pct"], 1.0);

  // The mapping of one row is refused to COLMAP: that is a row, too.
  const ProgramEnd both = Compare(
      {"--techniques", "vo,colmap", "--sweep", "mapping.method=seeded,none", "--repeat", "1"});
  ASSERT_EQ(both.exit_code, 0) << both.err;
  const json rows = Rows();
  ASSERT_EQ(rows.size(), 5U);  // colmap twice; vo as before and with both settings
  EXPECT_EQ(rows[0]["technique"], "colmap");
  EXPECT_EQ(rows[0]["setting"], "mapping.method=none");
  EXPECT_EQ(rows[0]["exit"], 2);
  EXPECT_THAT(rows[0]["reason"].get<std::string>(), HasSubstr("mapping.method"));
  EXPECT_EQ(rows[1]["setting"], "mapping.method=seeded");
  EXPECT_EQ(rows[1]["exit"], 3);  // nothing checks the focal length, which is known to 1 %
  EXPECT_LT(rows[1]["ate_se3_pct"], 1.0);
  EXPECT_EQ(rows[2]["technique"], "vo");
  // What the first run has found is not found anew, and its time is still told.
  EXPECT_EQ(rows[2]["seconds"], seconds);
  EXPECT_EQ(rows[3]["ate_se3_pct"], rows[2]["ate_se3_pct"]);
  EXPECT_THAT(both.out, HasSubstr("0/0/1"));
  EXPECT_TRUE(fs::exists(out_ / "comparison.csv"));

  const fs::path features =
      out_ / "runs" / SimulatedPartFolder().filename() / "vo" / "0" / "stages" / "features";
  for (const auto& entry : fs::directory_iterator(features)) {
    EXPECT_GT(fs::hard_link_count(entry.path()), 1U) << entry.path();  // kept once for all runs
  }

  // Pictures of what there is; a run that failed has none.
  const ProgramEnd plots = RunProgram(kPython, {RIGMAP_DOCS "/../tools/plot-comparison", out_});
  EXPECT_EQ(plots.exit_code, 0) << plots.err;
  const std::string part = SimulatedPartFolder().filename();
  for (const std::string& name : {part + "-routes", part + "-errors", part + "-map-vo",
                                  std::string("spread"), std::string("cost")}) {
    EXPECT_THAT(ReadTextFile(out_ / "plots" / (name + ".svg")), HasSubstr("</svg>")) << name;
  }

  // Results that lie anywhere can be compared as well: of the same frames, by what differs.
  const fs::path runs = out_ / "runs" / SimulatedPartFolder().filename();
  fs::copy(runs / "vo" / "0", folder_.Path() / "other", fs::copy_options::recursive);
  const ProgramEnd stored =
      RunRigmap({"compare", runs / "vo" / "0", runs / "colmap mapping.method=seeded" / "0",
                 folder_.Path() / "other", "--out", folder_.Path() / "stored"});
  ASSERT_EQ(stored.exit_code, 0) << stored.err;
  const json beside =
      json::parse(ReadTextFile(folder_.Path() / "stored" / "comparison.json"))["rows"];
  ASSERT_EQ(beside.size(), 3U);
  EXPECT_EQ(beside[0]["technique"], "colmap");
  EXPECT_EQ(beside[0]["part"], beside[1]["part"]);
  EXPECT_EQ(beside[0]["setting"], "");
  EXPECT_THAT(beside[1]["setting"].get<std::string>(), StartsWith("in "));
  EXPECT_NE(beside[1]["setting"], beside[2]["setting"]);
  EXPECT_EQ(beside[1]["ate_se3_pct"], beside[2]["ate_se3_pct"]);
}

TEST_F(CompareTest, KeepsApartWhatOptionsAndRigMakeDifferent) {
  const fs::path config = folder_.Path() / "fine.yaml", rig = SimulatedPartFolder() / "calib.yaml";
  WriteTestFile(config, "features:\n  min_uniqueness: 0.06\n");
  const std::vector<std::vector<std::string>> calls{{},
                                                    {"--set", "odometry.min_inliers=16"},
                                                    {"--config", config},
                                                    {"--rig", rig},
                                                    {"--accuracy", "2"}};
  for (std::vector<std::string> call : calls) {
    call.insert(call.end(), {"--techniques", "wheels"});  // refused, as there are none
    ASSERT_EQ(Compare(call).exit_code, 0);
  }
  std::vector<std::string> settings;
  for (const json& row : Rows()) settings.push_back(row["setting"]);
  EXPECT_THAT(settings,
              testing::ElementsAre("", "features.min_uniqueness=0.06", "gates.accuracy_pct=2",
                                   "odometry.min_inliers=16", StartsWith("rig=calib-")));
}

TEST_F(CompareTest, RepeatsGoOnFromTheSeedThatIsAskedFor) {
  CompareRequest request{.out = out_, .part = PartRequest{}};
  request.part->dataset.folder = SimulatedPartFolder();
  request.techniques = {Technique::kColmap};
  request.repeats = 2;
  request.sweeps = {ParseSweep("mapping.random_seed=0,7")};
  std::vector<int> seeds;
  for (const ComparisonRun& run : PlanComparison(request)) {
    seeds.push_back(run.request.options.mapping.random_seed);
  }
  EXPECT_THAT(seeds, testing::ElementsAre(0, 1, 7, 8));
}

TEST_F(CompareTest, OnlyOneWorksInAFolder) {
  const OutputLock lock(out_);
  const ProgramEnd end = Compare({"--techniques", "wheels"});
  EXPECT_EQ(end.exit_code, 1);
  EXPECT_THAT(end.LastErrorLine(), HasSubstr("another rigmap is working in this folder"));
  EXPECT_FALSE(fs::exists(out_ / "comparison.csv"));
}

TEST_F(CompareTest, DrivesOfTheSameNameStandBesideEachOther) {
  std::vector<fs::path> drives;
  for (const char* parent : {"a", "b"}) {
    fs::create_directories(folder_.Path() / parent / "drive");
    drives.push_back(CopyOfSimulatedPart(folder_.Path() / parent / "drive"));
  }
  for (const char* eye : {"left", "right"}) {
    fs::copy(drives[1] / eye / "0006.png", drives[1] / eye / "0007.png",
             fs::copy_options::overwrite_existing);
  }
  // Refused, for there are no wheels: that is enough.
  for (const fs::path& drive : {drives[0], drives[1], drives[0]}) {
    const ProgramEnd end = RunRigmap(
        {"compare", "--dataset", drive, "--techniques", "wheels", "--out", out_, "--quiet"});
    ASSERT_EQ(end.exit_code, 0) << end.err;
  }
  const json rows = Rows();
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_THAT(rows[0]["truth"].get<std::string>(), HasSubstr("groundtruth_tum.txt"));  // its own
  EXPECT_EQ(rows[0]["part"], "drive-data");
  EXPECT_THAT(rows[1]["part"].get<std::string>(), StartsWith("drive-data-"));
}

TEST_F(CompareTest, WhatElseLiesInItsFolderDoesNotDisturb) {
  const std::vector<std::string> accuracies{"--techniques", "vo", "--sweep",
                                            "gates.accuracy_pct=0.001,90"};
  ASSERT_EQ(Compare(accuracies).exit_code, 0);
  json rows = Rows();
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_THAT(rows[0]["reason"].get<std::string>(), HasSubstr("asked was 0.001 %"));
  EXPECT_THAT(rows[1]["reason"].dump(), testing::Not(HasSubstr("asked was 1 %")));
  EXPECT_EQ(rows[0]["truth"], (SimulatedPartFolder() / "groundtruth_tum.txt").string());

  const fs::path part = out_ / "runs" / SimulatedPartFolder().filename();
  const auto write = [](const fs::path& path, const char* text) {
    WriteFileAtomically(path, [&](std::ostream& stream) { stream << text; });
  };
  write(out_ / "runs" / "note.txt", "mine");
  write(part / "note.txt", "mine");
  write(part / "vo gates.accuracy_pct=90" / "1.json", "{\"half\": ");
  const ProgramEnd again = Compare(accuracies);
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(Rows(), rows);
}

TEST_F(CompareTest, IsNotPutAmongOtherFiles) {
  const fs::path data = CopyOfSimulatedPart(folder_.Path());
  const ProgramEnd end =
      RunRigmap({"compare", "--dataset", data, "--techniques", "wheels", "--out", data});
  EXPECT_EQ(end.exit_code, 1);
  EXPECT_THAT(end.LastErrorLine(), HasSubstr("holds no comparison of rigmap"));
  EXPECT_FALSE(fs::exists(data / "comparison.csv"));
  EXPECT_FALSE(fs::exists(data / "runs"));
}

TEST_F(CompareTest, KnowsBeforeTheFirstRunWhatCannotBe) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> wrong{
      {{"--techniques", "vo,magic"}, "'magic'"},
      {{"--techniques", "vo", "--sweep", "mapping.methd=none"}, "methd"},
      {{"--techniques", "vo", "--sweep", "mapping.method"}, "--sweep"},
      {{"--techniques", "vo", "--repeat", "0"}, "--repeat"}};
  for (const auto& [arguments, word] : wrong) {
    const ProgramEnd end = Compare(arguments);
    EXPECT_EQ(end.exit_code, 2) << word;
    EXPECT_THAT(end.LastErrorLine(), HasSubstr(word));
    EXPECT_FALSE(fs::exists(out_)) << word;
  }
  EXPECT_EQ(RunRigmap({"compare", "--out", out_}).exit_code, 2);
  // Results are compared as they are.
  const ProgramEnd judged =
      RunRigmap({"compare", "result", "--truth", folder_.Path(), "--out", out_});
  EXPECT_EQ(judged.exit_code, 2);
  EXPECT_THAT(judged.LastErrorLine(), HasSubstr("--truth: expected with --dataset alone"));
  EXPECT_EQ(RunRigmap({"compare", "result", "--repeat", "3", "--out", out_}).exit_code, 2);
}

TEST_F(CompareTest, TakesAllPartsThatFit) {
  const char* data = std::getenv("RIGMAP_DATA");
  if (!data) GTEST_SKIP() << "RIGMAP_DATA is not set";
  const fs::path beach = fs::path(data) / "beach-dev";
  const ProgramEnd end =
      RunRigmap({"compare", "--dataset", beach, "--traverse", "3", "--truth", beach / "truth",
                 "--techniques", "wheels", "--out", out_, "--quiet"});
  ASSERT_EQ(end.exit_code, 0) << end.err;
  const json rows = Rows();
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0]["part"], "beach-dev-traverse3-part1");
  EXPECT_EQ(rows[1]["part"], "beach-dev-traverse3-part2");
  EXPECT_NEAR(rows[0]["path_m"].get<double>(), 7.84, 0.01);  // each beside its own truth
  EXPECT_NEAR(rows[1]["path_m"].get<double>(), 5.19, 0.01);
  for (const json& row : rows) EXPECT_LT(row["ate_se3_pct"], 1.0);
}

}  // namespace
}  // namespace rigmap
