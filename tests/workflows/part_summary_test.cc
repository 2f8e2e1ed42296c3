#include "workflows/part_summary.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "core/file.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

using nlohmann::json;
using testing::ElementsAre;

class PartSummaryTest : public testing::Test {
 protected:
  PartSummaryTest() { request_.command = "rigmap part \"quoted\""; }
  json Written(const PartSummary& summary) {
    const StageRunner run({layout_, {}, {}, true});
    result_ = summary.Write(run);
    return json::parse(ReadTextFile(layout_.root / "summary.json"));
  }

  TemporaryFolder folder_;
  OutputLayout layout_{folder_.Path()};
  PartRequest request_;
  PartResult result_;
};

TEST_F(PartSummaryTest, HasAllKeysEvenWhereNothingWasReached) {
  const json summary = Written(PartSummary(request_));
  for (const char* key : {"status", "reason", "world_up", "stages", "frames", "scale", "gates",
                          "versions", "command"}) {
    EXPECT_TRUE(summary.contains(key)) << key;
  }
  for (const char* key : {"read", "paired", "keyframes", "registered", "posed"}) {
    EXPECT_TRUE(summary["frames"].at(key).is_null()) << key;
  }
  for (const char* key :
       {"metres_per_model_unit", "relative_spread", "pairs_used", "pairs_rejected"}) {
    EXPECT_TRUE(summary["scale"].contains(key)) << key;
  }
  EXPECT_EQ(summary["status"], "ok");
  EXPECT_TRUE(summary["reason"].is_null());
  EXPECT_EQ(summary["command"], request_.command);
  EXPECT_EQ(summary["versions"]["rigmap"], RIGMAP_VERSION);
}

TEST_F(PartSummaryTest, NamesEachUnreadableImageOnce) {
  PartSummary summary(request_);
  Dataset dataset;
  dataset.health.unreadable_images = {"b.png"};
  summary.SetDataset(dataset);
  summary.AddUnreadableImages({"a.png", "b.png"});
  EXPECT_THAT(Written(summary)["health"]["unreadable_images"], ElementsAre("a.png", "b.png"));
}

// Paths and other programs' output may hold any bytes.
TEST_F(PartSummaryTest, IsJsonWhateverTheReasonHolds) {
  PartSummary summary(request_);
  summary.Fail("colmap said \xff\x01");
  EXPECT_THAT(Written(summary)["reason"].get<std::string>(), testing::StartsWith("colmap said"));
}

TEST_F(PartSummaryTest, CountsFramesAndWhatWasPassedOver) {
  PartSummary summary(request_);
  Dataset dataset;
  dataset.frames.resize(5);
  dataset.health.images_read = 12;
  dataset.health.lone_images = {"a.png", "b.png"};
  summary.SetDataset(dataset);
  summary.SetKeyframes(4);
  PlacedKeyframes placed;
  placed.world_from_left = {Rigid3(), std::nullopt, Rigid3(), Rigid3()};
  placed.models.resize(2);
  placed.models[0].scale = {0.5, 0.001, {0, 2}, {}};
  placed.models[1].scale = {0.7, 0.003, {3}, {1}};
  summary.SetScale(placed);
  summary.SetTrajectory(Trajectory(5), WorldUp::kImu);
  summary.SetRevisits({{.a = 0, .b = 3}, {.a = 0, .b = 4, .by_appearance = true}});
  const json written = Written(summary);
  EXPECT_EQ(written["frames"],
            (json{{"read", 12}, {"paired", 5}, {"keyframes", 4}, {"registered", 3}, {"posed", 5}}));
  EXPECT_EQ(written["revisits"], (json{{"pairs", 2}, {"by_appearance", 1}}));
  EXPECT_EQ(written["health"]["lone_images"], (json{"a.png", "b.png"}));
  EXPECT_EQ(written["world_up"], "imu");
  EXPECT_EQ(written["scale"]["metres_per_model_unit"], 0.5);
  EXPECT_EQ(written["scale"]["relative_spread"], 0.003);  // of the worst model
  EXPECT_EQ(written["scale"]["pairs_used"], 3);
  EXPECT_EQ(written["scale"]["pairs_rejected"], json{1});
}

TEST_F(PartSummaryTest, SaysHowManyPosesWerePredicted) {
  Trajectory trajectory(5);
  for (TimedPose& pose : trajectory) pose.source = PoseSource::kAdjusted;
  PartSummary summary(request_);
  summary.SetTrajectory(trajectory, WorldUp::kImu);
  EXPECT_TRUE(Written(summary)["mapping"]["remarks"].empty());
  trajectory[3].source = PoseSource::kPredicted;
  summary.SetTrajectory(trajectory, WorldUp::kImu);
  EXPECT_THAT(Written(summary)["mapping"]["remarks"].at(0).get<std::string>(),
              testing::HasSubstr("1 of 5 poses"));
}

TEST_F(PartSummaryTest, FailedGateMakesThePartUntrusted) {
  PartSummary summary(request_);
  summary.AddGates({{"a", 0.5, 1.0, true, "fine"}, {"b", std::nullopt, 1.0, true, "unknown"}});
  EXPECT_EQ(Written(summary)["status"], "ok");
  EXPECT_EQ(result_.status, PartStatus::kTrusted);
  summary.AddGates({{"c", 3.0, 1.0, false, "too much of c"}});
  const json written = Written(summary);
  EXPECT_EQ(written["status"], "untrusted");
  EXPECT_EQ(written["reason"], result_.reason);
  EXPECT_EQ(result_.status, PartStatus::kUntrusted);
  EXPECT_TRUE(written["gates"][1]["value"].is_null());
  EXPECT_EQ(written["gates"][2], (json{{"name", "c"},
                                       {"value", 3.0},
                                       {"limit", 1.0},
                                       {"passed", false},
                                       {"why", "too much of c"}}));
}

TEST_F(PartSummaryTest, FailureIsTheReasonWhateverTheGatesSay) {
  PartSummary summary(request_);
  summary.AddGates({{"c", 3.0, 1.0, false, "too much of c"}});
  summary.Fail("colmap: not found");
  const json written = Written(summary);
  EXPECT_EQ(written["status"], "failed");
  EXPECT_EQ(written["reason"], "colmap: not found");
}

TEST_F(PartSummaryTest, LeavesTheOptionsAsAConfiguration) {
  request_.options.voxel.voxel_m = 0.1 / 3.0;
  request_.options.dense.method = DenseMethod::kBm;
  Written(PartSummary(request_));
  EXPECT_EQ(WritePartOptions(LoadPartOptions(folder_.Path() / "config.yaml", {})),
            WritePartOptions(request_.options));
}

}  // namespace
}  // namespace rigmap
