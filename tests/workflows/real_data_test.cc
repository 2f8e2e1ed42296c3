// The whole recipe on data that lies beside the project, where RIGMAP_DATA says.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "export/ply.h"
#include "tests/support/temporary_folder.h"
#include "tests/workflows/rigmap_program.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class RealData : public testing::Test {
 protected:
  void SetUp() override {
    const char* data = std::getenv("RIGMAP_DATA");
    if (!data) GTEST_SKIP() << "RIGMAP_DATA is not set";
    data_ = data;
  }
  ProgramEnd Run(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"part", "--out", out_, "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunRigmap(arguments);
  }
  json Evaluation(const fs::path& truth) const {
    return json::parse(RunRigmap({"evaluate", out_, "--truth", truth, "--json"}).out);
  }
  json JsonOf(const char* name) const { return json::parse(ReadTextFile(out_ / name)); }

  fs::path data_;
  TemporaryFolder folder_;
  fs::path out_ = folder_.Path() / "out";
};

// Equal to a unit of the last digit that is printed.
void ExpectEqual(const json& found, const json& expected) {
  EXPECT_EQ(found.size(), expected.size());
  for (const auto& [key, value] : expected.items()) {
    ASSERT_TRUE(found.contains(key)) << key;
    const bool coarse =
        key == "path_m" || key == "est_path_m" || key == "segment_m" || key == "scale_error_pct";
    EXPECT_NEAR(found[key].get<double>(), value.get<double>(), coarse ? 1.1e-3 : 1.1e-4) << key;
  }
}

// With block matching and coarse voxels: the surface is judged in the rooms that make it.
TEST_F(RealData, BeachPartIsMetric) {
  const fs::path truth = data_ / "beach-dev" / "truth" / "Part2";
  const ProgramEnd end =
      Run({"--dataset", data_ / "beach-dev", "--traverse", "3", "--part", "2", "--truth", truth,
           "--set", "dense.method=bm", "--set", "fusion.voxel_m=0.02"});
  ASSERT_EQ(end.exit_code, 0) << end.err;
  const json metrics = JsonOf("evaluation.json");
  EXPECT_EQ(metrics["coverage"], 1.0);
  EXPECT_LE(metrics["scale_error_pct"].get<double>(), 0.03);
  EXPECT_LE(metrics["ate_se3_pct"].get<double>(), 0.02);
  EXPECT_LE(metrics["rpe_t_pct"].get<double>(), 0.1);
  EXPECT_LE(metrics["rpe_r_deg_per_m"].get<double>(), 0.03);
  const json summary = JsonOf("summary.json");
  EXPECT_EQ(summary["frames"]["posed"], summary["frames"]["paired"]);
  EXPECT_EQ(summary["world_up"], "imu");
  EXPECT_TRUE(fs::exists(out_ / "trajectory_antenna.tum"));
  EXPECT_GT(ReadPly(out_ / "dense.ply").size(), 20000U);

  EXPECT_GT(metrics["rtk"]["used"], 5);
  // Each step by truth and fixes; the last is the result.
  EXPECT_EQ(metrics["steps"]["adjustment"]["rtk"], metrics["rtk"]);
  EXPECT_GT(metrics["steps"]["odometry"]["rtk"]["ce90_m"], 0.0);
  EXPECT_THAT(RunRigmap({"evaluate", out_}).out,
              testing::ContainsRegex("adjustment +[0-9.e-]+ .*\n"));

  const fs::path scorers = data_ / ".." / "score";
  if (!fs::exists(scorers) || !fs::exists(kPython)) {
    GTEST_SKIP() << "the scorers or Debian's python3 are missing: figures not compared with them";
  }
  const auto scored = [&](const char* name, const std::vector<std::string>& arguments) {
    std::vector<std::string> all{scorers / name};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const ProgramEnd scorer = RunProgram(kPython, all);
    EXPECT_EQ(scorer.exit_code, 0) << scorer.err;
    return json::parse(scorer.out);
  };
  const std::string tum = out_ / "trajectory.tum";
  EXPECT_EQ(metrics["map"], scored("map_metrics.py", {out_ / "dense.ply", tum, truth}));
  EXPECT_EQ(metrics["rocks"], scored("rock_fit.py", {out_ / "dense.ply", tum, truth}));
  json trajectory = metrics;
  for (const char* key : {"map", "map_sigmas", "rocks", "rtk", "surveyed_rocks", "steps", "drift",
                          "height_rms_m", "height_drift_pct"}) {
    trajectory.erase(key);
  }
  ExpectEqual(trajectory, scored("trajectory_metrics.py", {tum, truth / "trajectory.tum"}));
}

class RealMap : public RealData {};

// The default way from pairs to a surface: semi-global matching, voxels of 1 cm.
TEST_F(RealMap, OfABeachByDefaultIsCloseToTheTruth) {
  const fs::path truth = data_ / "beach-dev" / "truth" / "Part2";
  const ProgramEnd end =
      Run({"--dataset", data_ / "beach-dev", "--traverse", "3", "--part", "2", "--truth", truth});
  ASSERT_EQ(end.exit_code, 0) << end.err;
  const json map = Evaluation(truth)["map"];
  const json near = map["within_1.5m"], far = map["within_3.5m"];
  EXPECT_GE(near["f_1cm"].get<double>(), 0.93);
  EXPECT_GE(far["f_2cm"].get<double>(), 0.95);
  EXPECT_LE(far["stray_over_20cm_pct"].get<double>(), 0.01);
  // A surface that left out what is hard would have few strays, too.
  EXPECT_GE(near["completeness_1cm"].get<double>(), 0.93);
  EXPECT_GE(far["completeness_2cm"].get<double>(), 0.95);
  const json differences = JsonOf("summary.json")["depth_consistency"];
  EXPECT_LE(differences["radius"]["systematic_pct"].get<double>(), 0.05);
  EXPECT_LE(differences["place"]["systematic_pct"].get<double>(), 0.1);
}

// A rig that lies still must not invent motion. Its own calibration may not please the gates.
TEST_F(RealData, StillRigStandsStill) {
  const ProgramEnd end = Run({"--dataset", data_ / "euroc-still", "--until", "adjustment"});
  ASSERT_TRUE(end.exit_code == 0 || end.exit_code == 3) << end.err;
  const json metrics = Evaluation(data_ / "euroc-still" / "groundtruth_tum.txt");
  EXPECT_EQ(metrics["frames"], 8);
  // How good its metres are, nothing tells.
  const json verdict = JsonOf("summary.json")["verdict"];
  EXPECT_TRUE(verdict["scale_95_pct"].is_null());
  EXPECT_THAT(verdict["text"].get<std::string>(), testing::HasSubstr("for each metre of depth"));
  EXPECT_LE(metrics["extent_m"].get<double>(), 0.005);
}

TEST_F(RealData, DesertStepHasItsLength) {
  const ProgramEnd end = Run({"--dataset", data_ / "devon-pair", "--until", "adjustment"});
  ASSERT_TRUE(end.exit_code == 0 || end.exit_code == 3) << end.err;
  // Against itself: the figures of one trajectory.
  const json metrics = Evaluation(out_ / "trajectory.tum");
  EXPECT_EQ(metrics["frames"], 2);
  EXPECT_NEAR(metrics["extent_m"].get<double>(), 0.12, 0.010);
}

}  // namespace
}  // namespace rigmap
