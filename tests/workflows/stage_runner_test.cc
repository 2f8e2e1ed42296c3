#include "workflows/stage_runner.h"

#include <gmock/gmock.h>

#include "core/error.h"
#include "core/file.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_file.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::IsEmpty;

// A recipe of three stages in the order of the real one: each adds its name to the product of the
// one before. `odometry` has nothing to publish, `adjustment` publishes its product, `fusion`
// writes its file while it makes.
struct Recipe {
  std::string odometry_option = "a", adjustment_option = "b", fusion_option = "c";
  std::optional<std::string> until = {}, from = {};
  std::string fails_at = {};
};

class StageRunnerTest : public testing::Test {
 protected:
  // What was made anew or published, in order.
  std::vector<std::string> Run(const Recipe& recipe) {
    deeds_.clear();
    StageRunner run({layout_, recipe.until, recipe.from, true});
    try {
      const auto odometry = run.Run(Stage<std::string>{
          .name = "odometry",
          .options = recipe.odometry_option,
          .make = [&] { return Make(recipe, "odometry", recipe.odometry_option); },
      });
      const auto adjustment = run.Run(Stage<std::string>{
          .name = "adjustment",
          .options = recipe.adjustment_option,
          .make = [&] { return Make(recipe, "adjustment", odometry + recipe.adjustment_option); },
          .report = [&](const std::string& product) { reported_ = product; },
          .publish = [&](const std::string& product) { Publish(recipe, tum_, product); },
          .published = {tum_},
      });
      product_ = run.Run(Stage<std::string>{
          .name = "fusion",
          .options = recipe.fusion_option,
          .make =
              [&] {
                WriteTestFile(ply_, adjustment + recipe.fusion_option);
                return Make(recipe, "fusion", adjustment + recipe.fusion_option);
              },
          .published = {ply_},
      });
    } catch (const StopAfterStage&) {
      deeds_.push_back("stop");
    }
    records_ = run.records();
    return deeds_;
  }

  std::vector<bool> Reused() const {
    std::vector<bool> reused;
    for (const StageRecord& record : records_) reused.push_back(record.reused);
    return reused;
  }

  std::string Make(const Recipe& recipe, const std::string& stage, const std::string& product) {
    if (recipe.fails_at == stage) throw DataError("failed in " + stage);
    deeds_.push_back("make " + stage);
    return product;
  }
  void Publish(const Recipe& recipe, const fs::path& path, const std::string& product) {
    if (recipe.fails_at == "publish") throw DataError("failed in publish");
    deeds_.push_back("publish");
    WriteTestFile(path, product);
  }

  TemporaryFolder folder_;
  OutputLayout layout_{folder_.Path()};
  fs::path tum_ = folder_.Path() / "trajectory.tum", ply_ = folder_.Path() / "dense.ply";
  std::vector<std::string> deeds_;
  std::vector<StageRecord> records_;
  std::string product_, reported_;
};

const std::vector<std::string> kAll{"make odometry", "make adjustment", "publish", "make fusion"};

TEST_F(StageRunnerTest, MakesEverythingOnceAndThenReusesIt) {
  EXPECT_EQ(Run({}), kAll);
  EXPECT_THAT(Reused(), ElementsAre(false, false, false));
  EXPECT_EQ(product_, "abc");
  product_ = reported_ = "";
  EXPECT_THAT(Run({}), IsEmpty());
  EXPECT_THAT(Reused(), ElementsAre(true, true, true));
  EXPECT_EQ(product_, "abc");
  EXPECT_EQ(reported_, "ab");  // what is reused is reported too
}

TEST_F(StageRunnerTest, RecordsStagesByNameWithTimeAndMemory) {
  Run({});
  ASSERT_EQ(records_.size(), 3U);
  EXPECT_EQ(records_[1].name, "adjustment");
  EXPECT_GE(records_[1].seconds, 0.0);
  EXPECT_GT(records_[1].peak_rss_mb, 1.0);
  EXPECT_TRUE(fs::exists(layout_.Log("adjustment")));
}

TEST_F(StageRunnerTest, ChangedOptionRedoesItsStageAndAllBehind) {
  Run({});
  EXPECT_THAT(Run({.fusion_option = "C"}), ElementsAre("make fusion"));
  EXPECT_THAT(Run({.adjustment_option = "B", .fusion_option = "C"}),
              ElementsAre("make adjustment", "publish", "make fusion"));
  EXPECT_THAT(Reused(), ElementsAre(true, false, false));
  EXPECT_EQ(Run({.odometry_option = "A", .adjustment_option = "B", .fusion_option = "C"}), kAll);
  EXPECT_EQ(product_, "ABC");
  EXPECT_EQ(ReadTextFile(tum_), "AB");
}

// The option of one stage must not be taken for that of its neighbour.
TEST_F(StageRunnerTest, OptionsOfNeighboursAreToldApart) {
  Run({.odometry_option = "xy", .adjustment_option = ""});
  EXPECT_EQ(Run({.odometry_option = "x", .adjustment_option = "y"}), kAll);
}

TEST_F(StageRunnerTest, FromRedoesThatStageAndAllBehind) {
  Run({});
  EXPECT_THAT(Run({.from = "adjustment"}),
              ElementsAre("make adjustment", "publish", "make fusion"));
  // A stage that the recipe passes over counts by its place in the order.
  EXPECT_THAT(Run({.from = "dense"}), ElementsAre("make fusion"));
  EXPECT_EQ(Run({.from = "dataset"}), kAll);
}

TEST_F(StageRunnerTest, UntilStopsWithThatStagePublished) {
  EXPECT_THAT(Run({.until = "adjustment"}),
              ElementsAre("make odometry", "make adjustment", "publish", "stop"));
  EXPECT_EQ(ReadTextFile(tum_), "ab");
  EXPECT_FALSE(fs::exists(ply_));
  EXPECT_THAT(Run({}), ElementsAre("make fusion"));
}

TEST_F(StageRunnerTest, MissingPublishedFileIsWrittenAgain) {
  Run({});
  fs::remove(tum_);
  EXPECT_THAT(Run({}), ElementsAre("publish"));
  EXPECT_THAT(Reused(), ElementsAre(true, true, true));
  EXPECT_EQ(ReadTextFile(tum_), "ab");
  fs::remove(ply_);
  EXPECT_THAT(Run({}), ElementsAre("make fusion"));
}

TEST_F(StageRunnerTest, DamagedArtefactIsMadeAnew) {
  Run({});
  const fs::path artefact = layout_.Artefact("adjustment");
  fs::resize_file(artefact, fs::file_size(artefact) - 3);
  EXPECT_THAT(Run({}), ElementsAre("make adjustment", "publish", "make fusion"));
  // What was made from the same inputs holds, whoever made them.
  WriteTestFile(layout_.Artefact("odometry"), "noise");
  EXPECT_THAT(Run({}), ElementsAre("make odometry", "publish", "make fusion"));
  EXPECT_EQ(product_, "abc");
}

TEST_F(StageRunnerTest, NoFileOfAnEarlierProductLiesBesideANewerOne) {
  Run({});
  Run({.adjustment_option = "B", .until = "adjustment"});
  EXPECT_EQ(ReadTextFile(tum_), "aB");
  EXPECT_FALSE(fs::exists(ply_));
}

TEST_F(StageRunnerTest, FailureWhileMakingLeavesNothingOfThatStage) {
  Run({});
  EXPECT_THROW(Run({.adjustment_option = "B", .fails_at = "adjustment"}), DataError);
  EXPECT_FALSE(fs::exists(tum_));
  EXPECT_FALSE(fs::exists(ply_));
  EXPECT_THAT(Run({}), ElementsAre("make adjustment", "publish", "make fusion"));
  EXPECT_EQ(ReadTextFile(tum_), "ab");
}

TEST_F(StageRunnerTest, FailureAfterPublishingLeavesNothingOfThatStage) {
  StageRunner run({layout_, {}, {}, true});
  const auto make = [&]() -> std::string {
    WriteTestFile(ply_, "half a map");
    fs::create_directories(layout_.Scratch());
    throw DataError("failed after writing");
  };
  EXPECT_THROW(run.Run(Stage<std::string>{.name = "fusion", .options = "", .make = make}),
               DataError);
  EXPECT_FALSE(fs::exists(ply_));
  EXPECT_FALSE(fs::exists(layout_.Scratch()));
}

// Otherwise a run that was killed between the two would be taken for complete.
TEST_F(StageRunnerTest, ProductThatWasNotPublishedDoesNotCountAsKept) {
  Run({});
  EXPECT_THROW(Run({.adjustment_option = "B", .fails_at = "publish"}), DataError);
  EXPECT_THAT(Run({.adjustment_option = "B"}),
              ElementsAre("make adjustment", "publish", "make fusion"));
  EXPECT_EQ(ReadTextFile(tum_), "aB");
}

TEST(StageNames, AreKnownAndOrdered) {
  EXPECT_TRUE(IsStageName("dataset"));
  EXPECT_TRUE(IsStageName("evaluation"));
  EXPECT_FALSE(IsStageName("gates"));
  EXPECT_FALSE(IsStageName(""));
  EXPECT_TRUE(ComesBefore("features", "odometry"));
  EXPECT_FALSE(ComesBefore("odometry", "odometry"));
  EXPECT_FALSE(ComesBefore("fusion", "dense"));
}

}  // namespace
}  // namespace rigmap
