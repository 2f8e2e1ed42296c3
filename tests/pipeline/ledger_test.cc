#include "pipeline/ledger.h"

#include <gmock/gmock.h>

#include "tests/support/temporary_folder.h"
#include "tests/support/test_file.h"

namespace rigmap {
namespace {

using testing::ElementsAre;

Ledger TwoStages() {
  Ledger ledger{.recipe = "rig", .stages = {}};
  ledger.Put({.name = "odometry",
              .key = "k1",
              .seconds = 1.5,
              .peak_rss_mb = 20.25,
              .published = {"trajectory.tum", "sparse"},
              .report = {{"frames", {{"keyframes", 3}}}}});
  ledger.Put({.name = "gates", .key = "k2", .listed = false, .report = Report::object()});
  return ledger;
}

TEST(LedgerTest, ReadsBackWhatWasWritten) {
  const TemporaryFolder folder;
  const Ledger written = TwoStages();
  WriteLedger(written, folder.Path());
  const Ledger read = ReadLedger(folder.Path());
  EXPECT_EQ(read.recipe, "rig");
  ASSERT_EQ(read.stages.size(), 2U);
  const StageRecord& stage = read.stages[0];
  EXPECT_EQ(stage.name, "odometry");
  EXPECT_EQ(stage.key, "k1");
  EXPECT_EQ(stage.seconds, 1.5);
  EXPECT_EQ(stage.peak_rss_mb, 20.25);
  EXPECT_THAT(stage.published, ElementsAre("trajectory.tum", "sparse"));
  EXPECT_EQ(stage.report, written.stages[0].report);
  EXPECT_TRUE(stage.listed);
  EXPECT_FALSE(read.stages[1].listed);
}

// What this run has not done was left by one before.
TEST(LedgerTest, SaysThatWhatItReadsIsReused) {
  const TemporaryFolder folder;
  WriteLedger(TwoStages(), folder.Path());
  for (const StageRecord& record : ReadLedger(folder.Path()).stages) EXPECT_TRUE(record.reused);
}

TEST(LedgerTest, ReplacesTheRecordOfTheSameName) {
  Ledger ledger = TwoStages();
  ledger.Put({.name = "odometry", .key = "k3"});
  EXPECT_EQ(ledger.stages.size(), 2U);
  ASSERT_NE(ledger.Find("odometry"), nullptr);
  EXPECT_EQ(ledger.Find("odometry")->key, "k3");
  ledger.Remove("odometry");
  EXPECT_EQ(ledger.Find("odometry"), nullptr);
  EXPECT_EQ(ledger.stages.size(), 1U);
}

TEST(LedgerTest, IsEmptyWhereThereIsNoneOrADamagedOne) {
  const TemporaryFolder folder;
  EXPECT_TRUE(ReadLedger(folder.Path()).stages.empty());
  WriteLedger(TwoStages(), folder.Path());
  for (const char* text : {"", "{", "{}", "[1]", R"({"recipe": 3, "stages": []})",
                           R"({"recipe": "rig", "stages": [{"name": "odometry"}]})"}) {
    WriteTestFile(folder.Path() / "stages" / "ledger.json", text);
    EXPECT_TRUE(ReadLedger(folder.Path()).stages.empty()) << text;
  }
}

}  // namespace
}  // namespace rigmap
