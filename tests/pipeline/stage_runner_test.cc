#include "pipeline/stage_runner.h"

#include <gmock/gmock.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <future>

#include "core/error.h"
#include "core/file.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_file.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::UnorderedElementsAre;

struct TextOptions {
  int number = 0;
  OptionFields Fields() { return {{"number", &number}}; }
};

// What the stages of a run did, in order. Stages are plain functions, hence not a member.
std::vector<std::string> deeds;
std::string fails_at;

std::string Deed(const std::string& stage, const std::string& product) {
  if (fails_at == stage) throw DataError("failed in " + stage);
  deeds.push_back("make " + stage);
  return product;
}

// A recipe of two branches on one stem:
//   given -> odometry -> adjustment -> { fusion, evaluation }, and a check on adjustment.
// Each adds its number to the text that it takes. `odometry` has nothing to publish, `adjustment`
// publishes its product, `fusion` writes its file while it makes.
std::string Odometry(const StageContext&, const std::string& given, const TextOptions& o) {
  return Deed("odometry", given + std::to_string(o.number));
}
std::string Adjustment(const StageContext& context, const std::string& text, const TextOptions& o) {
  if (fails_at == "half-way") {
    WriteTestFile(context.root / "trajectory.tum", "half");
    fs::create_directories(context.scratch);
  }
  if (fails_at == "half-way") throw DataError("failed half-way");
  return Deed("adjustment", text + std::to_string(o.number));
}
void PublishAdjustment(Publication& publication, const StageContext&, const std::string& product,
                       const std::string&) {
  if (fails_at == "publish") throw DataError("failed in publish");
  deeds.push_back("publish adjustment");
  publication.File("trajectory.tum", [&](std::ostream& stream) { stream << product; });
}
Report ReportAdjustment(const std::string& product, const std::string&) {
  return {{"text", product}};
}
std::string Fusion(const StageContext& context, const std::string& text, const TextOptions& o) {
  const std::string product = text + std::to_string(o.number);
  context.publication->File("dense.ply", [&](std::ostream& stream) { stream << product; });
  return Deed("fusion", product);
}
std::string Evaluation(const StageContext&, const std::string& text, const TextOptions& o) {
  return Deed("evaluation", text + std::to_string(o.number));
}
Report Judge(const std::string& text, const TextOptions& o) {
  deeds.push_back("check");
  return {{"verdict", text + std::to_string(o.number)}};
}

// Moves what the adjustment has made, and publishes it in its place.
std::string Tie(const StageContext&, const std::string& text, const TextOptions&) {
  return Deed("tie", "t" + text.substr(1));
}

struct Recipe {
  std::string given = "a";
  int odometry = 1, adjustment = 2, fusion = 3, evaluation = 4, check = 5;
  std::string_view fusion_code = "code";
  std::optional<std::string> until = {}, from = {};
  bool is_tied = false;
};

using TextStage = Stage<std::string, Takes<std::string>, Reads<TextOptions>>;

StageGraph GraphOf(const Recipe& recipe) {
  StageGraph graph;
  const auto given = graph.AddSource<std::string>(
      "given", [given = recipe.given] { return std::pair(given, given); });
  const auto odometry =
      graph.AddStage(TextStage{.name = "odometry", .code = "code", .make = Odometry},
                     Reading(TextOptions{recipe.odometry}), given);
  TextStage adjust{.name = "adjustment",
                   .code = "code",
                   .make = Adjustment,
                   .publishes = {"trajectory.tum"},
                   .publish = PublishAdjustment,
                   .report = ReportAdjustment};
  TextStage tie{.name = "tie", .code = "code", .make = Tie};
  if (recipe.is_tied) {
    std::swap(adjust.publishes, tie.publishes);
    std::swap(adjust.publish, tie.publish);
  }
  const auto adjustment = graph.AddStage(adjust, Reading(TextOptions{recipe.adjustment}), odometry);
  if (recipe.is_tied) graph.AddStage(tie, Reading(TextOptions()), adjustment);
  graph.AddCheck(Check<Takes<std::string>, Reads<TextOptions>>{"check", "code", Judge},
                 Reading(TextOptions{recipe.check}), adjustment);
  graph.AddStage(
      TextStage{
          .name = "fusion", .code = recipe.fusion_code, .make = Fusion, .publishes = {"dense.ply"}},
      Reading(TextOptions{recipe.fusion}), adjustment);
  graph.AddStage(TextStage{.name = "evaluation", .code = "code", .make = Evaluation},
                 Reading(TextOptions{recipe.evaluation}), adjustment);
  return graph;
}

class StageRunnerTest : public testing::Test {
 protected:
  StageRunnerTest() { fails_at.clear(); }

  // What was made anew, published or checked, in order.
  std::vector<std::string> Run(const Recipe& recipe) {
    deeds.clear();
    const StageGraph graph = GraphOf(recipe);
    StageRunner runner(graph, root_,
                       {"test", recipe.until, recipe.from, 100, {"dense.ply", "trajectory.tum"}});
    outdated_ = runner.outdated_outputs();
    Job job(1, true);
    job.Run([&] { runner.Run(job); });
    ledger_ = runner.ledger();
    return deeds;
  }
  std::vector<std::string> Reused() const {
    std::vector<std::string> reused;
    for (const StageRecord& record : ledger_.stages) {
      if (record.reused && record.name != "given") reused.push_back(record.name);
    }
    return reused;
  }
  std::vector<std::string> Recorded() const {
    std::vector<std::string> names;
    for (const StageRecord& record : ledger_.stages) {
      if (record.name != "given") names.push_back(record.name);
    }
    return names;
  }
  fs::path ProductOf(const std::string& stage) const {
    for (const auto& entry : fs::directory_iterator(root_ / "stages")) {
      if (entry.path().filename().string().starts_with(stage + "-")) return entry.path();
    }
    return {};
  }

  TemporaryFolder folder_;
  fs::path root_ = folder_.Path();
  fs::path tum_ = root_ / "trajectory.tum", ply_ = root_ / "dense.ply";
  std::vector<std::string> outdated_;
  Ledger ledger_;
};

const std::vector<std::string> kAll{"make odometry", "make adjustment", "publish adjustment",
                                    "check",         "make fusion",     "make evaluation"};
const std::vector<std::string> kNames{"odometry", "adjustment", "check", "fusion", "evaluation"};

TEST_F(StageRunnerTest, MakesEverythingOnceAndThenReusesIt) {
  EXPECT_EQ(Run({}), kAll);
  EXPECT_THAT(Reused(), IsEmpty());
  EXPECT_EQ(Recorded(), kNames);
  EXPECT_EQ(ReadTextFile(ply_), "a123");
  EXPECT_THAT(Run({}), IsEmpty());
  EXPECT_EQ(Reused(), kNames);
  EXPECT_EQ(ledger_.Find("adjustment")->report, (Report{{"text", "a12"}}));
  EXPECT_EQ(ledger_.Find("check")->report, (Report{{"verdict", "a125"}}));
}

std::string DrawVerdict(const StageContext&, const Report& report) {
  return Deed("drawing", report["verdict"].get<std::string>());
}
Report ReportDrawing(const std::string& product, const Report&) { return {{"text", product}}; }

// A drawing that bears a check's verdict.
StageGraph GraphWithDrawing(int check_number) {
  StageGraph graph;
  const auto given = graph.AddSource<std::string>(
      "given", [] { return std::pair<std::string, std::string>("a", "a"); });
  const auto check =
      graph.AddCheck(Check<Takes<std::string>, Reads<TextOptions>>{"check", "code", Judge},
                     Reading(TextOptions{check_number}), given);
  graph.AddStage(
      Stage<std::string, Takes<Report>, Reads<>>{
          .name = "drawing", .code = "code", .make = DrawVerdict, .report = ReportDrawing},
      Reading(), check);
  return graph;
}

TEST_F(StageRunnerTest, WhatACheckReportsMayBeTaken) {
  std::string drawn;
  const auto run = [&](int check_number) {
    deeds.clear();
    const StageGraph graph = GraphWithDrawing(check_number);
    StageRunner runner(graph, root_, {"test", "drawing", {}, 100, {}});
    Job job(1, true);
    job.Run([&] { runner.Run(job); });
    drawn = runner.ledger().Find("drawing")->report["text"];
    return deeds;
  };
  EXPECT_THAT(run(5), ElementsAre("check", "make drawing"));
  EXPECT_EQ(drawn, "a5");
  EXPECT_THAT(run(5), IsEmpty());
  // As the ledger remembers it, where the check holds but not the drawing.
  fs::remove(ProductOf("drawing"));
  EXPECT_THAT(run(5), ElementsAre("make drawing"));
  EXPECT_EQ(drawn, "a5");
  EXPECT_THAT(run(6), ElementsAre("check", "make drawing"));
  EXPECT_EQ(drawn, "a6");
}

TEST_F(StageRunnerTest, RecordsTimeMemoryAndALog) {
  Run({});
  const StageRecord* record = ledger_.Find("adjustment");
  ASSERT_NE(record, nullptr);
  EXPECT_GE(record->seconds, 0.0);
  EXPECT_GT(record->peak_rss_mb, 1.0);
  EXPECT_THAT(record->published, ElementsAre("trajectory.tum"));
  EXPECT_TRUE(fs::exists(root_ / "logs" / "adjustment.log"));
}

TEST_F(StageRunnerTest, ChangedOptionRedoesItsStageAndWhatDependsOnItOnly) {
  Run({});
  EXPECT_THAT(Run({.fusion = 30}), ElementsAre("make fusion"));
  EXPECT_EQ(ReadTextFile(ply_), "a1230");
  EXPECT_THAT(Run({.fusion = 30, .evaluation = 40}), ElementsAre("make evaluation"));
  EXPECT_THAT(Run({.fusion = 30, .evaluation = 40, .check = 50}), ElementsAre("check"));
  EXPECT_THAT(Reused(), ElementsAre("odometry", "adjustment", "fusion", "evaluation"));
  EXPECT_EQ(Run({.odometry = 10, .fusion = 30, .evaluation = 40, .check = 50}), kAll);
  EXPECT_EQ(ReadTextFile(tum_), "a102");
}

TEST_F(StageRunnerTest, ChangedInputOrCodeRedoesWhatDependsOnIt) {
  Run({});
  EXPECT_THAT(Run({.fusion_code = "other code"}), ElementsAre("make fusion"));
  EXPECT_EQ(Run({.given = "b"}), kAll);
  EXPECT_EQ(ReadTextFile(tum_), "b12");
}

// Of each stage two products are kept, so that two techniques do not drive each other out.
TEST_F(StageRunnerTest, GoingBackRedoesNothingThatIsKept) {
  Run({});
  Run({.adjustment = 20});
  EXPECT_THAT(Run({}), ElementsAre("publish adjustment", "check", "make fusion"));
  EXPECT_EQ(ReadTextFile(tum_), "a12");
  EXPECT_EQ(ReadTextFile(ply_), "a123");
  Run({.adjustment = 20});
  Run({.adjustment = 21});
  EXPECT_THAT(Run({}), testing::Contains("make adjustment"));
}

// The option of one stage must not be taken for that of its neighbour.
TEST_F(StageRunnerTest, OptionsOfNeighboursAreToldApart) {
  Run({.odometry = 1, .adjustment = 12});
  EXPECT_EQ(Run({.odometry = 11, .adjustment = 2}), kAll);
}

TEST_F(StageRunnerTest, FromRedoesThatStageAndItsDescendantsAnew) {
  Run({});
  EXPECT_THAT(Run({.from = "fusion"}), ElementsAre("make fusion"));
  EXPECT_THAT(Run({.from = "adjustment"}), ElementsAre("make adjustment", "publish adjustment",
                                                       "check", "make fusion", "make evaluation"));
  EXPECT_EQ(Run({.from = "given"}), kAll);
}

TEST_F(StageRunnerTest, UntilDoesThatStageItsAncestorsAndTheirChecks) {
  EXPECT_THAT(Run({.until = "odometry"}), ElementsAre("make odometry"));
  EXPECT_THAT(Run({.until = "adjustment"}),
              ElementsAre("make adjustment", "publish adjustment", "check"));
  // A branch beside it is no ancestor.
  EXPECT_THAT(Run({.until = "evaluation"}), ElementsAre("make evaluation"));
  EXPECT_FALSE(fs::exists(ply_));
  EXPECT_THAT(Run({}), ElementsAre("make fusion"));
}

TEST_F(StageRunnerTest, ShorterRunKeepsAndRecordsWhatStillHolds) {
  Run({});
  EXPECT_THAT(Run({.until = "odometry"}), IsEmpty());
  EXPECT_EQ(Recorded(), kNames);
  EXPECT_THAT(outdated_, IsEmpty());
  EXPECT_EQ(ReadTextFile(ply_), "a123");
}

TEST_F(StageRunnerTest, ShorterRunNamesAndRemovesWhatDoesNotHold) {
  Run({});
  EXPECT_THAT(Run({.adjustment = 20, .until = "odometry"}), IsEmpty());
  EXPECT_THAT(outdated_, UnorderedElementsAre("trajectory.tum", "dense.ply"));
  EXPECT_THAT(Recorded(), ElementsAre("odometry"));
  EXPECT_FALSE(fs::exists(tum_));
  EXPECT_FALSE(fs::exists(ply_));
}

TEST_F(StageRunnerTest, WritesNothingBeforeItIsTold) {
  Run({});
  const StageGraph graph = GraphOf({.adjustment = 20});
  const StageRunner runner(graph, root_, {"test", {}, {}, 100, {"dense.ply", "trajectory.tum"}});
  EXPECT_THAT(runner.outdated_stages(), ElementsAre("adjustment", "check", "fusion", "evaluation"));
  EXPECT_TRUE(fs::exists(tum_));
  EXPECT_TRUE(fs::exists(ply_));
}

TEST_F(StageRunnerTest, MissingPublishedFileIsWrittenAgain) {
  Run({});
  fs::remove(tum_);
  EXPECT_THAT(Run({}), ElementsAre("publish adjustment"));
  EXPECT_EQ(Reused(), kNames);
  EXPECT_EQ(ReadTextFile(tum_), "a12");
  fs::remove(ply_);
  EXPECT_THAT(Run({}), ElementsAre("make fusion"));
}

// The other has as many bytes, so that its size does not tell.
TEST_F(StageRunnerTest, WhatALaterStagePublishedGoesWithThatStage) {
  Run({});
  for (int i = 0; i < 2; ++i) {
    Run({.is_tied = true});
    EXPECT_EQ(ReadTextFile(tum_), "t12");
    EXPECT_THAT(Run({}), ElementsAre("publish adjustment"));
    EXPECT_EQ(ReadTextFile(tum_), "a12");
    EXPECT_THAT(Run({}), IsEmpty());
  }
}

TEST_F(StageRunnerTest, DamagedProductIsMadeAnewAndWhatHoldsIsKept) {
  Run({});
  fs::resize_file(ProductOf("adjustment"), fs::file_size(ProductOf("adjustment")) - 3);
  EXPECT_THAT(Run({}), ElementsAre("make adjustment", "publish adjustment"));
  WriteTestFile(ProductOf("odometry"), "noise");
  EXPECT_THAT(Run({}), ElementsAre("make odometry"));
}

// Damage that only reading it shows: the key and the end are there.
TEST_F(StageRunnerTest, ProductDamagedInsideIsMadeAnewWhenItIsNeeded) {
  Run({});
  const fs::path product = ProductOf("adjustment");
  std::string bytes = ReadTextFile(product);
  const auto line_end = bytes.find('\n');
  bytes.erase(line_end + 1, bytes.size() - line_end - 5);
  WriteTestFile(product, bytes);
  EXPECT_THAT(Run({.fusion = 30}),
              ElementsAre("make adjustment", "publish adjustment", "make fusion"));
  EXPECT_EQ(ReadTextFile(ply_), "a1230");
}

TEST_F(StageRunnerTest, LostLedgerCostsWhatWasPublishedOnly) {
  Run({});
  fs::remove(root_ / "stages" / "ledger.json");
  EXPECT_THAT(Run({}), ElementsAre("publish adjustment", "check", "make fusion"));
  EXPECT_THAT(outdated_, UnorderedElementsAre("trajectory.tum", "dense.ply"));
  EXPECT_EQ(ledger_.Find("adjustment")->report, (Report{{"text", "a12"}}));
}

TEST_F(StageRunnerTest, FailureWhileMakingLeavesNothingOfThatStage) {
  Run({});
  fails_at = "half-way";
  EXPECT_THROW(Run({.adjustment = 20}), DataError);
  EXPECT_FALSE(fs::exists(tum_));
  EXPECT_FALSE(fs::exists(ply_));
  EXPECT_FALSE(fs::exists(root_ / "stages" / "scratch-adjustment"));
  const Ledger left = ReadLedger(root_);
  ASSERT_EQ(left.stages.size(), 2U);
  EXPECT_EQ(left.stages[1].name, "odometry");
  fails_at.clear();
  EXPECT_THAT(Run({.adjustment = 20}), ElementsAre("make adjustment", "publish adjustment", "check",
                                                   "make fusion", "make evaluation"));
}

TEST_F(StageRunnerTest, RemovesTheScratchThatAKilledRunHasLeft) {
  Run({});
  fs::create_directories(root_ / "stages" / "scratch-fusion" / "deep");
  EXPECT_THAT(Run({.until = "odometry"}), IsEmpty());
  EXPECT_FALSE(fs::exists(root_ / "stages" / "scratch-fusion"));
}

// Otherwise a run that was killed between the two would be taken for complete.
TEST_F(StageRunnerTest, ProductThatWasNotPublishedDoesNotCountAsKept) {
  fails_at = "publish";
  EXPECT_THROW(Run({}), DataError);
  fails_at.clear();
  EXPECT_THAT(Run({.until = "adjustment"}),
              ElementsAre("make adjustment", "publish adjustment", "check"));
}

// Of two stages on one stem and what takes both: the first of them waits until the second is done.
std::promise<void> odometry_done;

std::string Mapping(const StageContext& context, const std::string& text, const TextOptions& o) {
  constexpr auto kLongEnough = std::chrono::seconds(60);
  const bool is_beside =
      odometry_done.get_future().wait_for(kLongEnough) == std::future_status::ready;
  spdlog::info("mapping was here");
  context.publication->File("dense.ply", [&](std::ostream& stream) { stream << "a model"; });
  if (fails_at == "mapping") throw DataError("failed in mapping");
  return text + (is_beside ? " beside " : " alone ") + std::to_string(o.number);
}
std::string OdometryMeanwhile(const StageContext&, const std::string& given, const TextOptions&) {
  odometry_done.set_value();
  if (fails_at == "odometry") throw DataError("failed in odometry");
  return Deed("odometry", given);
}
std::string Both(const StageContext&, const std::string& one, const std::string& other) {
  return Deed("both", one + ", " + other);
}
Report ReportMapping(const std::string& product, const std::string&) { return {{"text", product}}; }
Report ReportBoth(const std::string& product, const std::string&, const std::string&) {
  return {{"text", product}};
}

StageGraph GraphThatWaits() {
  StageGraph graph;
  const auto given = graph.AddSource<std::string>(
      "given", [] { return std::pair<std::string, std::string>("a", "a"); });
  const auto mapped = graph.AddStage(TextStage{.name = "mapping",
                                               .code = "code",
                                               .make = Mapping,
                                               .publishes = {"dense.ply"},
                                               .report = ReportMapping,
                                               .waits_for_child = true},
                                     Reading(TextOptions{1}), given);
  const auto odometry =
      graph.AddStage(TextStage{.name = "odometry", .code = "code", .make = OdometryMeanwhile},
                     Reading(TextOptions{2}), given);
  graph.AddStage(
      Stage<std::string, Takes<std::string, std::string>, Reads<>>{
          .name = "both", .code = "code", .make = Both, .report = ReportBoth},
      Reading(), mapped, odometry);
  return graph;
}

class WaitingStageTest : public StageRunnerTest {
 protected:
  void RunWaiting() {
    deeds.clear();
    odometry_done = {};
    const StageGraph graph = GraphThatWaits();
    StageRunner runner(graph, root_, {"test", {}, {}, 100, {"dense.ply"}});
    Job job(1, true);
    job.Run([&] { runner.Run(job); });
    ledger_ = runner.ledger();
  }
};

TEST_F(WaitingStageTest, WhatDoesNotTakeItIsDoneMeanwhile) {
  RunWaiting();
  EXPECT_EQ(ledger_.Find("both")->report["text"], "a beside 1, a");
  EXPECT_THAT(Recorded(), ElementsAre("mapping", "odometry", "both"));
  EXPECT_THAT(ledger_.Find("mapping")->published, ElementsAre("dense.ply"));
  EXPECT_THAT(ReadTextFile(root_ / "logs" / "mapping.log"), HasSubstr("mapping was here"));
  EXPECT_THAT(ReadTextFile(root_ / "logs" / "odometry.log"), Not(HasSubstr("mapping was here")));
  RunWaiting();
  EXPECT_THAT(Reused(), ElementsAre("mapping", "odometry", "both"));
  EXPECT_THAT(deeds, IsEmpty());
}

TEST_F(WaitingStageTest, ItsFailureLeavesWhatWasDoneMeanwhile) {
  fails_at = "mapping";
  EXPECT_THROW(RunWaiting(), DataError);
  EXPECT_FALSE(fs::exists(ply_));
  ASSERT_EQ(ReadLedger(root_).stages.size(), 2U);
  EXPECT_EQ(ReadLedger(root_).stages[1].name, "odometry");
}

TEST_F(WaitingStageTest, IsKeptWhereAnotherFailsMeanwhile) {
  fails_at = "odometry";
  EXPECT_THROW(RunWaiting(), DataError);
  EXPECT_EQ(ReadTextFile(ply_), "a model");
  fails_at.clear();
  RunWaiting();
  EXPECT_THAT(Reused(), ElementsAre("mapping"));
  EXPECT_EQ(ledger_.Find("both")->report["text"], "a beside 1, a");
}

TEST_F(StageRunnerTest, SourceThatIsNotToBeHadFailsOnlyWhereItIsNeeded) {
  StageGraph graph;
  const auto given = graph.AddSource<std::string>(
      "given", [] { return std::pair<std::string, std::string>("a", "a"); });
  const auto missing = graph.AddSource<std::string>(
      "missing",
      []() -> std::pair<std::string, std::string> { throw DataError("it is not there"); });
  graph.AddStage(TextStage{.name = "odometry", .code = "code", .make = Odometry},
                 Reading(TextOptions{1}), given);
  graph.AddStage(TextStage{.name = "evaluation", .code = "code", .make = Evaluation},
                 Reading(TextOptions{1}), missing);
  EXPECT_THROW(StageRunner(graph, root_, {"test", {}, {}, 100, {}}), DataError);
  StageRunner runner(graph, root_, {"test", "odometry", {}, 100, {}});
  Job job(1, true);
  job.Run([&] { runner.Run(job); });
  EXPECT_NE(runner.ledger().Find("odometry"), nullptr);
}

}  // namespace
}  // namespace rigmap
