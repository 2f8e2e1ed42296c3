#include "workflows/part_summary.h"

#include <gmock/gmock.h>

#include "pipeline/code_identity.h"

namespace rigmap {
namespace {

using testing::ElementsAre;
using testing::StartsWith;

Report GateReport(const char* name, double value, bool passed) {
  return {{"gates",
           {{{"name", name},
             {"value", value},
             {"limit", 1.0},
             {"passed", passed},
             {"why", std::string("too much of ") + name}}}}};
}

class PartSummaryTest : public testing::Test {
 protected:
  PartSummaryTest() { request_.command = "rigmap part \"quoted\""; }
  void Add(const std::string& stage, Report report, bool listed = true) {
    ledger_.Put({.name = stage, .listed = listed, .report = std::move(report)});
  }
  Report Written(const std::string& failure = "") const {
    return Report::parse(WriteSummary(ledger_, "rig", request_, failure));
  }

  Ledger ledger_;
  PartRequest request_;
};

TEST_F(PartSummaryTest, HasAllKeysEvenWhereNothingWasReached) {
  const Report summary = Written();
  for (const char* key : {"status", "reason", "technique", "world_up", "stages", "frames",
                          "revisits", "health", "mapping", "scale", "rig", "map", "gates",
                          "depth_consistency", "verdict", "versions", "command"}) {
    EXPECT_TRUE(summary.contains(key)) << key;
  }
  for (const char* key : {"read", "paired", "keyframes", "registered", "posed"}) {
    EXPECT_TRUE(summary["frames"].at(key).is_null()) << key;
  }
  for (const char* key :
       {"metres_per_model_unit", "relative_spread", "pairs_used", "pairs_rejected"}) {
    EXPECT_TRUE(summary["scale"].contains(key)) << key;
  }
  EXPECT_EQ(summary["technique"], "rig");
  EXPECT_EQ(summary["command"], request_.command);
  EXPECT_EQ(summary["versions"]["rigmap"], SourceVersion());
}

TEST_F(PartSummaryTest, PutsReportsTogether) {
  Add("dataset",
      {{"frames", {{"read", 12}, {"paired", 5}}}, {"health", {{"unreadable_images", {"b.png"}}}}});
  Add("features", {{"health", {{"unreadable_images", {"a.png", "b.png"}}}}});
  Add("odometry", {{"frames", {{"keyframes", 4}}}});
  Add("mapping", {{"mapping", {{"method", "seeded"}, {"remarks", {"one"}}}}});
  Add("adjustment", {{"mapping", {{"remarks", {"two"}}}},
                     {"rig", {{"refined", true}, {"right_eye_turned_deg", {0.1, 0.2, 0.3}}}},
                     {"world_up", "imu"}});
  const Report summary = Written();
  EXPECT_EQ(summary["frames"], (Report{{"read", 12},
                                       {"paired", 5},
                                       {"keyframes", 4},
                                       {"registered", nullptr},
                                       {"posed", nullptr}}));
  EXPECT_THAT(summary["health"]["unreadable_images"], ElementsAre("a.png", "b.png"));
  EXPECT_EQ(summary["mapping"]["method"], "seeded");
  EXPECT_THAT(summary["mapping"]["remarks"], ElementsAre("one", "two"));
  EXPECT_THAT(summary["rig"]["right_eye_turned_deg"], ElementsAre(0.1, 0.2, 0.3));
  EXPECT_TRUE(summary["rig"]["focal_changed_pct"].is_null());
  EXPECT_EQ(summary["world_up"], "imu");
}

TEST_F(PartSummaryTest, ListsStagesButNotChecks) {
  Add("odometry", Report::object());
  Add("gates", GateReport("a", 0.5, true), false);
  const Report summary = Written();
  ASSERT_EQ(summary["stages"].size(), 1U);
  EXPECT_EQ(summary["stages"][0]["name"], "odometry");
  for (const char* key : {"seconds", "peak_rss_mb", "reused"}) {
    EXPECT_TRUE(summary["stages"][0].contains(key)) << key;
  }
}

// Paths and other programs' output may hold any bytes.
TEST_F(PartSummaryTest, IsJsonWhateverTheReasonHolds) {
  EXPECT_THAT(Written("colmap said \xff\x01")["reason"].get<std::string>(),
              StartsWith("colmap said"));
}

TEST_F(PartSummaryTest, IsPartialUntilAGateWasAsked) {
  EXPECT_EQ(Written()["status"], "partial");
  EXPECT_EQ(Written()["reason"], "no gate checked yet");
  Add("gates", GateReport("a", 0.5, true), false);
  EXPECT_EQ(Written()["status"], "ok");
  EXPECT_TRUE(Written()["reason"].is_null());
}

TEST_F(PartSummaryTest, FailedGateMakesThePartUntrusted) {
  Add("gates", GateReport("a", 0.5, true), false);
  Add("depth_gates", GateReport("c", 3.0, false), false);
  const Report summary = Written();
  EXPECT_EQ(summary["status"], "untrusted");
  EXPECT_EQ(summary["reason"], Judge(ledger_).reason);
  EXPECT_EQ(summary["reason"], "too much of c: 3 (limit 1) (gate c)");
  EXPECT_EQ(summary["verdict"]["causes"][0]["gates"], Report({"c"}));
  EXPECT_EQ(summary["verdict"]["usable"], "nothing");
  ASSERT_EQ(summary["gates"].size(), 2U);
  EXPECT_EQ(summary["gates"][1], (Report{{"name", "c"},
                                         {"value", 3.0},
                                         {"limit", 1.0},
                                         {"passed", false},
                                         {"why", "too much of c"}}));
}

Report VerdictReport(double value, bool passed, const std::string& name) {
  Report report = GateReport(name.c_str(), value, passed);
  report["verdict"] = {{"text", "metres good to 0.4 % (95 %)"},
                       {"scale_95_pct", 0.4},
                       {"position_95_m", 0.05},
                       {"accuracy_asked_pct", 1.0}};
  return report;
}

TEST_F(PartSummaryTest, VerdictSaysWhetherFiguresHoldAndHowGoodTheyAre) {
  EXPECT_TRUE(Written()["verdict"]["text"].is_null());
  Add("gates", VerdictReport(0.4, true, "scale_95_pct"), false);
  EXPECT_EQ(Written()["verdict"]["text"], "metres good to 0.4 % (95 %)");
  EXPECT_EQ(Written()["verdict"]["scale_95_pct"], 0.4);
  EXPECT_EQ(Judge(ledger_).verdict, "metres good to 0.4 % (95 %)");
  Add("gates", VerdictReport(1.4, false, "scale_95_pct"), false);
  EXPECT_EQ(
      Written()["verdict"]["text"],
      "consistent, but not as good as the 1 % of the path asked for: metres good to 0.4 % (95 %)");
  // What contradicts itself is said first, though it came last.
  Add("depth_gates", GateReport("c", 3.0, false), false);
  EXPECT_THAT(Written()["verdict"]["text"].get<std::string>(),
              StartsWith("inconsistent: too much of c; were it right: metres"));
}

TEST_F(PartSummaryTest, FailureIsTheReasonWhateverTheGatesSay) {
  Add("gates", GateReport("c", 3.0, false), false);
  const Report summary = Written("colmap: not found");
  EXPECT_EQ(summary["status"], "failed");
  EXPECT_EQ(summary["reason"], "colmap: not found");
}

}  // namespace
}  // namespace rigmap
