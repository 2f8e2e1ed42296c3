// Reports of runs: every figure beside its file, and what a browser makes of them.
#include <gmock/gmock.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/file.h"
#include "report/bundle.h"
#include "report/thin_cloud.h"
#include "tests/report/sample_result.h"
#include "tests/support/temporary_folder.h"
#include "tests/workflows/report_figures.h"
#include "tests/workflows/rigmap_program.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using Json = nlohmann::ordered_json;

Json Load(const fs::path& path) { return Json::parse(ReadTextFile(path)); }

std::string PathOfChromium() {
  const std::string found = RunProgram("sh", {"-c", "command -v chromium"}).out;
  return found.substr(0, found.find('\n'));
}

bool HasBrowser() {
  return !ReportScripts().empty() && !std::string(RIGMAP_NODE).empty() && !PathOfChromium().empty();
}

#define SKIP_WITHOUT_BROWSER() \
  if (!HasBrowser()) GTEST_SKIP() << "no chromium, or built without node"

// Where screenshots are kept, if a person wants to look at them.
std::string FolderOfShots(const std::string& name) {
  const char* shots = std::getenv("RIGMAP_SHOTS");
  if (!shots) return "";
  const fs::path folder = fs::path(shots) / name;
  fs::create_directories(folder);
  return folder;
}

ProgramEnd Browse(const fs::path& result, const std::string& check, const std::string& shots = "") {
  return RunProgram(RIGMAP_NODE,
                    {RIGMAP_REPORT_BROWSER, RIGMAP_REPORT_PACKAGES, PathOfChromium(),
                     result / "report.html", check, shots.empty() ? "" : FolderOfShots(shots)});
}

void ExpectBrowses(const fs::path& result, const std::string& check, const std::string& shots) {
  const ProgramEnd end = Browse(result, check, shots);
  EXPECT_EQ(end.exit_code, 0) << result << ", " << check << ": " << end.err;
}

// Of the page's own data.
Json MapFiguresOf(const std::string& page) {
  const std::string start = "id=\"report-data\">";
  const auto from = page.find(start) + start.size();
  return Json::parse(page.substr(from, page.find("</script>", from) - from))["map"];
}

// Fourteen pairs past rocks, with truth, fixes and survey; then refused, then failed.
class ReportTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    const ProgramEnd simulated =
        RunProgram(RIGMAP_SIMULATE_PROGRAM,
                   {"--scene", "rocks", "--path", "s-curve", "--pairs", "14", "--spacing", "0.2",
                    "--seed", "2", "--image-scale", "0.5", "--depth-every", "1000", "--out",
                    folder_->Path() / "simulated", "--quiet"});
    ASSERT_EQ(simulated.exit_code, 0) << simulated.err;
    ASSERT_EQ(Run("good", {}).exit_code, 0);
    fs::copy(Out("good"), Out("refused"),
             fs::copy_options::recursive | fs::copy_options::copy_symlinks);
    ASSERT_EQ(Run("refused", {"--accuracy", "0.0001"}).exit_code, 3);
    ASSERT_EQ(Run("failed", {}, "/nowhere").exit_code, 1);
  }
  static void TearDownTestSuite() { delete folder_; }

  static fs::path Out(const std::string& name) { return folder_->Path() / name; }
  static ProgramEnd Run(const std::string& name, const std::vector<std::string>& more,
                        const std::string& path = std::getenv("PATH")) {
    std::vector<std::string> arguments{"PATH=" + path,
                                       RIGMAP_PROGRAM,
                                       "part",
                                       "--dataset",
                                       folder_->Path() / "simulated" / "data",
                                       "--truth",
                                       folder_->Path() / "simulated" / "truth" / "Part1",
                                       "--out",
                                       Out(name),
                                       "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunProgram("/usr/bin/env", arguments);
  }
  static std::string Page(const std::string& name) {
    return ReadTextFile(Out(name) / "report.html");
  }

  inline static TemporaryFolder* folder_ = nullptr;
};

TEST_F(ReportTest, HasEveryFigureAsTheFilesHaveIt) {
  for (const char* name : {"good", "refused"}) {
    const std::string page = Page(name);
    std::map<std::string, Json> documents{{"summary", Load(Out(name) / "summary.json")},
                                          {"evaluation", Load(Out(name) / "evaluation.json")},
                                          {"georeference", Load(Out(name) / "georeference.json")}};
    if (!ReportScripts().empty()) documents["map"] = MapFiguresOf(page);
    std::map<std::string, std::set<std::string>> shown;
    for (const ReportFigure& figure : FiguresOf(page)) {
      shown[figure.source].insert(figure.pointer);
      if (!documents.contains(figure.source)) continue;
      EXPECT_EQ(Complaint(figure, documents[figure.source]), "");
    }
    for (const std::string& pointer : NumbersIn(documents["evaluation"])) {
      // Of steps only what tells them apart.
      EXPECT_TRUE(pointer.starts_with("/steps/") || shown["evaluation"].contains(pointer))
          << pointer;
    }
    for (const char* pointer : {"/steps/odometry/ate_se3_pct", "/steps/adjustment/ate_se3_pct",
                                "/steps/adjustment/rtk/rms_residual_m"}) {
      EXPECT_TRUE(shown["evaluation"].contains(pointer)) << pointer;
    }
    for (const std::string& pointer : NumbersIn(documents["summary"])) {
      // Indices and what the verdict's sentences are told from.
      const bool is_told = !pointer.starts_with("/gates/") && !pointer.starts_with("/stages/") &&
                           !pointer.starts_with("/frames/");
      EXPECT_TRUE(is_told || shown["summary"].contains(pointer)) << pointer;
    }
    for (const char* pointer :
         {"/verdict/scale_95_pct", "/verdict/position_95_m", "/verdict/known/path_m",
          "/rig/infinity_offset_sigma_px", "/depth_consistency/radius/rings/0/depth_pct"}) {
      EXPECT_TRUE(shown["summary"].contains(pointer)) << pointer;
    }
  }
}

TEST_F(ReportTest, TellsOfTheMapWhatIsInIt) {
  if (ReportScripts().empty()) GTEST_SKIP() << "built without node";
  const Json map = MapFiguresOf(Page("good"));
  const ThinCloud cloud = ReadThinCloud(Out("good") / "dense.ply", 1'000'000);
  EXPECT_EQ(map["points"], cloud.count_in_map);
  ASSERT_TRUE(cloud.rocks && !cloud.rocks->empty());
  EXPECT_DOUBLE_EQ(map["largest_rock"]["height_m"], cloud.rocks->front().height_m);
  EXPECT_DOUBLE_EQ(map["median_sigma_m"], cloud.median_sigma_m.value());
}

TEST_F(ReportTest, OfARefusedPartSaysWhyAndWhatToTry) {
  const std::string page = Page("refused");
  const Json summary = Load(Out("refused") / "summary.json");
  EXPECT_THAT(page, HasSubstr("Do not trust this result"));
  EXPECT_THAT(page, HasSubstr("To try next"));
  EXPECT_THAT(page, HasSubstr("class=\"state bad\">failed"));
}

TEST_F(ReportTest, OfAFailedPartSaysWhatHappened) {
  EXPECT_THAT(Page("failed"), HasSubstr("The run failed"));
  EXPECT_THAT(Page("failed"), HasSubstr("colmap: not found on PATH"));
}

TEST_F(ReportTest, IsMadeAnewByTheCommand) {
  fs::remove(Out("good") / "report.html");
  const ProgramEnd end = RunRigmap({"report", Out("good"), Out("refused")});
  EXPECT_EQ(end.exit_code, 0) << end.err;
  EXPECT_EQ(end.out, (Out("good") / "report.html").string() + "\n" +
                         (Out("refused") / "report.html").string() + "\n");
  EXPECT_THAT(Page("good"), HasSubstr("This result can be trusted"));
}

TEST_F(ReportTest, OfAFolderWithoutAResultIsASentence) {
  const auto foreign = folder_->Write("foreign/thesis.tex", "x").parent_path();
  const ProgramEnd end = RunRigmap({"report", Out("good"), foreign});
  EXPECT_EQ(end.exit_code, 1);
  EXPECT_THAT(end.LastErrorLine(), HasSubstr("neither summary.json nor comparison.json"));
  EXPECT_FALSE(fs::exists(foreign / ".lock"));
}

TEST_F(ReportTest, ComparesResults) {
  const ProgramEnd end =
      RunRigmap({"compare", Out("good"), Out("refused"), "--out", Out("compared")});
  ASSERT_EQ(end.exit_code, 0) << end.err;
  const std::string page = Page("compared");
  EXPECT_THAT(page, HasSubstr("1 of 2 runs can be trusted"));
  const Json comparison = Load(Out("compared") / "comparison.json");
  const auto figures = FiguresOf(page);
  EXPECT_GE(figures.size(), 12U);
  for (const ReportFigure& figure : figures) EXPECT_EQ(Complaint(figure, comparison), "");
  SKIP_WITHOUT_BROWSER();
  ExpectBrowses(Out("compared"), "comparison", "comparison");
}

TEST_F(ReportTest, IsWellInABrowser) {
  SKIP_WITHOUT_BROWSER();
  ExpectBrowses(Out("good"), "looks", "good");
  ExpectBrowses(Out("good"), "view", "good");
  ExpectBrowses(Out("good"), "without-webgl", "good");
  ExpectBrowses(Out("refused"), "looks", "refused");
  ExpectBrowses(Out("failed"), "looks", "failed");
}

TEST(ReportViewTest, MeasuresTwoPickedPointsAndIsHarmless) {
  SKIP_WITHOUT_BROWSER();
  const TemporaryFolder folder;
  const auto result = WriteSampleResult(folder, "<script>alert(1)<");
  ASSERT_EQ(RunRigmap({"report", result}).exit_code, 0);
  ExpectBrowses(result, "distance", "distance");
  ExpectBrowses(result, "looks", "distance");
}

// The part of tools/demo.
TEST(ReportOfTheDemo, KeepsItsBudgets) {
  SKIP_WITHOUT_BROWSER();
  const TemporaryFolder folder;
  const ProgramEnd simulated =
      RunProgram(RIGMAP_SIMULATE_PROGRAM,
                 {"--scene", "beach", "--path", "s-curve", "--pairs", "40", "--spacing", "0.2",
                  "--seed", "2", "--out", folder.Path() / "simulated", "--quiet"});
  ASSERT_EQ(simulated.exit_code, 0) << simulated.err;
  const ProgramEnd part = RunRigmap({"part", "--dataset", folder.Path() / "simulated" / "data",
                                     "--truth", folder.Path() / "simulated" / "truth" / "Part1",
                                     "--out", folder.Path() / "result", "--quiet"});
  ASSERT_EQ(part.exit_code, 0) << part.err;
  EXPECT_LT(fs::file_size(folder.Path() / "result" / "report.html"), 15'000'000U);
  ExpectBrowses(folder.Path() / "result", "view", "demo");
  double load = 0.0;
  if (getloadavg(&load, 1) == 1 && load > 2.0 * std::thread::hardware_concurrency()) {
    GTEST_SKIP() << "times mean nothing: the machine is busy with other work";
  }
  const ProgramEnd times = Browse(folder.Path() / "result", "times");
  ASSERT_EQ(times.exit_code, 0) << times.err;
  const Json best = Json::parse(times.out);
  EXPECT_LT(best["first"].get<double>(), 1000.0);
  EXPECT_LT(best["view"].get<double>(), 3000.0);
  EXPECT_LT(best["frame"].get<double>(), 16.0);
}

}  // namespace
}  // namespace rigmap
