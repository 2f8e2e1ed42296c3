// The whole recipe on a small simulated beach, from the command line to the files.
#include "tests/support/simulated_part.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "colmap/model_io.h"
#include "core/file.h"
#include "dataset/rig_file.h"
#include "export/ply.h"
#include "export/tum.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_file.h"
#include "tests/workflows/rigmap_program.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::Each;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::IsSubsetOf;
using testing::Not;

using Arguments = std::vector<std::string>;

Arguments PartArguments(const fs::path& out, const Arguments& more = {}) {
  Arguments arguments{"part", "--dataset", SimulatedPartFolder(), "--out", out, "--quiet"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

void RunPart(const fs::path& out, const Arguments& more = {}) {
  const ProgramEnd end = RunRigmap(PartArguments(out, more));
  ASSERT_EQ(end.exit_code, 0) << end.err;
  EXPECT_EQ(end.out, "");
}

json JsonOf(const fs::path& path) { return json::parse(ReadTextFile(path)); }

// Names of the stages that the last run reused, in order.
std::vector<std::string> Reused(const fs::path& out) {
  std::vector<std::string> names;
  const json summary = JsonOf(out / "summary.json");
  for (const json& stage : summary["stages"]) {
    if (stage["reused"]) names.push_back(stage["name"]);
  }
  return names;
}

const Arguments kPublished{"trajectory.tum",
                           "trajectory_kitti.txt",
                           "trajectory.csv",
                           "trajectory_midpoint.tum",
                           "trajectory_antenna.tum",
                           "sparse/images.bin",
                           "sparse/points3D.bin",
                           "sparse.ply",
                           "dense.ply",
                           "height.tif",
                           "ortho.tif",
                           "terrain.tif",
                           "dense.las",
                           "view_top.png",
                           "view_side.png",
                           "view_oblique.png",
                           "evaluation.json",
                           "config.yaml"};

std::vector<std::string> Bytes(const fs::path& out, const Arguments& names = kPublished) {
  std::vector<std::string> bytes;
  for (const std::string& name : names) bytes.push_back(ReadTextFile(out / name));
  return bytes;
}

class SimulatedPartTest : public testing::Test {
 protected:
  void ExpectTrajectoryLikeTruth() const {
    const json metrics = JsonOf(out_ / "evaluation.json");
    EXPECT_EQ(metrics["coverage"], 1.0);
    EXPECT_LT(metrics["ate_se3_pct"].get<double>(), 0.03);
    EXPECT_LT(metrics["scale_error_pct"].get<double>(), 0.05);
    const ProgramEnd end = RunRigmap(
        {"evaluate", out_, "--truth", SimulatedPartFolder() / "groundtruth_tum.txt", "--json"});
    EXPECT_EQ(json::parse(end.out), metrics);
  }

  // Every dense point against the surface that was photographed.
  void ExpectSurfaceLikeTruth() const {
    const SimulatedPart part;
    const Rigid3 truth_from_world =
        part.frames().front().world_from_left *
        ReadTum(out_ / "trajectory.tum").front().world_from_body.Inverse();
    const PointCloud points = ReadPly(out_ / "dense.ply");
    ASSERT_GT(points.size(), 20000U);
    std::vector<double> errors_m;
    for (const SurfacePoint& point : points) {
      const Eigen::Vector3d x = truth_from_world * point.x_in_world.cast<double>();
      errors_m.push_back(std::abs(part.HeightAboveGround(x)));
    }
    std::sort(errors_m.begin(), errors_m.end());
    EXPECT_LT(errors_m[errors_m.size() / 2], 0.005);
    EXPECT_LT(errors_m[errors_m.size() * 95 / 100], 0.03);
  }

  void ExpectSummary() const {
    const json summary = JsonOf(out_ / "summary.json");
    EXPECT_EQ(summary["status"], "ok");
    EXPECT_EQ(summary["frames"]["read"], 16);
    EXPECT_EQ(summary["frames"]["paired"], 8);
    EXPECT_EQ(summary["frames"]["posed"], 8);
    EXPECT_EQ(summary["frames"]["registered"], summary["frames"]["keyframes"]);
    EXPECT_GT(summary["scale"]["metres_per_model_unit"].get<double>(), 0.0);
    EXPECT_EQ(summary["stages"].size(), 20U);
    EXPECT_EQ(summary["gates"].size(), 23U);
    EXPECT_TRUE(summary["versions"]["colmap"].is_string());
    EXPECT_EQ(ReadTum(out_ / "trajectory.tum").size(), 8U);
  }

  // The result is for COLMAP's own tools.
  void ExpectColmapReadsIt() const {
    const auto colmap = [&](const Arguments& arguments) {
      const ProgramEnd end = RunProgram("colmap", arguments);
      EXPECT_EQ(end.exit_code, 0) << arguments[0] << "\n" << end.err;
      return end.out + end.err;
    };
    const std::string sparse = out_ / "sparse";
    EXPECT_THAT(colmap({"model_analyzer", "--path", sparse}),
                testing::HasSubstr("Registered images: 16"));
    const fs::path text = folder_.Path() / "text", undistorted = folder_.Path() / "undistorted";
    fs::create_directories(text);
    colmap(
        {"model_converter", "--input_path", sparse, "--output_path", text, "--output_type", "TXT"});
    EXPECT_TRUE(fs::exists(text / "points3D.txt"));
    colmap({"image_undistorter", "--image_path", out_ / "colmap" / "images", "--input_path", sparse,
            "--output_path", undistorted});
    const std::string name = ReadModel(out_ / "sparse").images.front().name;
    EXPECT_TRUE(fs::exists(undistorted / "images" / name)) << name;
  }

  TemporaryFolder folder_;
  fs::path out_ = folder_.Path() / "out";
};

TEST_F(SimulatedPartTest, IsMetricCompleteAndReadByOthers) {
  RunPart(out_);
  ExpectSummary();
  ExpectTrajectoryLikeTruth();
  ExpectSurfaceLikeTruth();
  ExpectColmapReadsIt();
  for (const std::string& name : FilesIn(out_)) EXPECT_FALSE(IsTemporaryName(name)) << name;
}

TEST_F(SimulatedPartTest, IsReusedWholeAndWhatIsMissingIsMadeAgain) {
  RunPart(out_);
  const auto before = Bytes(out_);
  RunPart(out_);
  EXPECT_EQ(Reused(out_).size(), 20U);
  EXPECT_TRUE(Bytes(out_) == before);
  for (const char* name : {"trajectory.csv", "dense.ply", "evaluation.json"})
    fs::remove(out_ / name);
  fs::remove_all(out_ / "sparse");
  fs::remove_all(out_ / "colmap" / "models");
  RunPart(out_);
  EXPECT_TRUE(fs::exists(out_ / "colmap" / "models" / "0" / "images.bin"));
  EXPECT_TRUE(Bytes(out_) == before);
}

TEST_F(SimulatedPartTest, ChangedOptionRedoesItsStageAndThoseBehind) {
  RunPart(out_, {"--until", "scale"});
  RunPart(out_, {"--until", "scale", "--set", "matching.neighbours=3"});
  EXPECT_THAT(Reused(out_), ElementsAre("dataset", "features", "odometry", "bridging"));
  RunPart(out_, {"--until", "scale", "--set", "matching.neighbours=3", "--from", "mapping"});
  EXPECT_THAT(Reused(out_),
              ElementsAre("dataset", "features", "odometry", "bridging", "matching", "database"));
  // A limit that no stage chooses its way by is no reason to do anything anew.
  RunPart(out_,
          {"--until", "scale", "--set", "matching.neighbours=3", "--set", "gates.predicted=1"});
  EXPECT_EQ(Reused(out_).size(), 8U);
}

TEST_F(SimulatedPartTest, UntilLeavesWhatItsStagesPublish) {
  RunPart(out_, {"--until", "dataset"});
  EXPECT_EQ(JsonOf(out_ / "summary.json")["frames"]["paired"], 8);
  EXPECT_FALSE(fs::exists(out_ / "trajectory.tum"));
  RunPart(out_, {"--until", "database"});
  EXPECT_TRUE(fs::exists(out_ / "colmap" / "database.db"));
  EXPECT_FALSE(fs::exists(out_ / "colmap" / "models"));
  RunPart(out_, {"--until", "adjustment"});
  const auto files = FilesIn(out_);
  EXPECT_THAT((Arguments{"colmap/models/0/images.bin", "config.yaml", "logs/mapping.log",
                         "sparse.ply", "sparse/cameras.bin", "sparse/images.bin",
                         "sparse/points3D.bin", "summary.json", "trajectory.csv", "trajectory.tum",
                         "trajectory_antenna.tum", "trajectory_midpoint.tum"}),
              IsSubsetOf(files));
  EXPECT_THAT(files, Each(Not(testing::AnyOf("dense.ply", "evaluation.json"))));
}

TEST_F(SimulatedPartTest, RunsFromAnywhereThroughALinkOnRelativePaths) {
  const fs::path link = folder_.Path() / "a link", work = folder_.Path() / "work";
  fs::create_directories(work);
  fs::create_symlink(RIGMAP_PROGRAM, link);
  fs::create_directory_symlink(SimulatedPartFolder(), work / "my data");
  const ProgramEnd end = RunProgram(
      link, {"part", "--dataset", "my data", "--out", "results/1", "--until", "database"}, work);
  EXPECT_EQ(end.exit_code, 0) << end.err;
  EXPECT_EQ(end.out, "");
  const fs::path image = work / "results/1/colmap/images/left" / "1448551418849000000.png";
  EXPECT_TRUE(fs::exists(image));
  EXPECT_THAT(FilesIn(work), Each(testing::AnyOf(testing::StartsWith("results"), "my data")));
}

TEST_F(SimulatedPartTest, IsTheSameWithOneThreadAndWithTwo) {
  const fs::path other = folder_.Path() / "other";
  RunPart(out_, {"--threads", "1"});
  RunPart(other, {"--threads", "2"});
  EXPECT_TRUE(Bytes(out_) == Bytes(other));
}

TEST_F(SimulatedPartTest, ThatIsKilledAtAnyMomentEndsAsIfItHadNotBeen) {
  const fs::path other = folder_.Path() / "other";
  RunPart(other);
  for (const char* moment : {"stages/features", "logs/odometry.log", "colmap", "logs/mapping.log",
                             "logs/scale.log", "sparse.ply", "stages/dense", "logs/fusion.log"}) {
    const pid_t process = StartRigmap(PartArguments(out_));
    for (int waited_ms = 0; !fs::exists(out_ / moment) && waited_ms < 60000; ++waited_ms) {
      usleep(1000);
    }
    KillHard(process);
    EXPECT_TRUE(fs::exists(out_ / moment)) << moment;
    for (int waited_ms = 0; ProcessesOn(out_) > 0 && waited_ms < 5000; ++waited_ms) usleep(1000);
    EXPECT_EQ(ProcessesOn(out_), 0) << "a child outlived its parent at " << moment;
  }
  RunPart(out_);
  EXPECT_TRUE(Bytes(out_) == Bytes(other));
  for (const std::string& name : FilesIn(out_)) EXPECT_FALSE(IsTemporaryName(name)) << name;
}

TEST_F(SimulatedPartTest, IsRefusedWhileAnotherRunIsAtIt) {
  const pid_t process = StartRigmap(PartArguments(out_));
  while (!fs::exists(out_ / "logs" / "features.log")) usleep(1000);
  const ProgramEnd second = RunRigmap(PartArguments(out_));
  KillHard(process);
  EXPECT_EQ(second.exit_code, 1);
  EXPECT_THAT(second.LastErrorLine(), testing::HasSubstr("another rigmap"));
}

// Two pixels of disparity: 3 % of the depth at 2 m.
TEST_F(SimulatedPartTest, WithAWrongRigIsCorrectedOrNotTrusted) {
  const fs::path data = CopyOfSimulatedPart(folder_.Path());
  std::string rig = ReadTextFile(data / "calib.yaml");
  const auto cx = rig.find("161.7");
  ASSERT_NE(cx, std::string::npos);
  rig.replace(cx, 5, "163.7");
  WriteTestFile(data / "calib.yaml", rig);
  const std::vector<std::string> part{"part", "--dataset", data,        "--out",
                                      out_,   "--until",   "adjustment"};
  std::vector<std::string> held = part;
  held.insert(held.end(), {"--set", "adjustment.refine_rig=none"});
  const ProgramEnd end = RunRigmap(held);
  EXPECT_EQ(end.exit_code, 3);
  EXPECT_THAT(end.LastErrorLine(), testing::HasSubstr("not to be trusted: gate "));
  EXPECT_EQ(JsonOf(out_ / "summary.json")["status"], "untrusted");
  EXPECT_TRUE(fs::exists(out_ / "trajectory.tum"));
  EXPECT_FALSE(fs::exists(out_ / "rig_refined.yaml"));

  // Mended, and as good as it says: eight small frames hardly tell principal points from turns.
  const ProgramEnd corrected = RunRigmap(part);
  EXPECT_EQ(corrected.exit_code, 0);
  EXPECT_THAT(corrected.err, testing::HasSubstr("has been corrected"));
  const json summary = JsonOf(out_ / "summary.json");
  EXPECT_EQ(summary["rig"]["refined"], true);
  EXPECT_THAT(summary["mapping"]["remarks"].dump(), testing::HasSubstr("contradict"));
  EXPECT_THAT(summary["mapping"]["remarks"].dump(),
              testing::HasSubstr("odometry and matching done anew"));
  EXPECT_NEAR(ReadRigFile(out_ / "rig_refined.yaml").Baseline(), 0.12, 1e-3);
  const ProgramEnd metrics =
      RunRigmap({"evaluate", out_, "--truth", data / "groundtruth_tum.txt", "--json"});
  const double scale_95_pct = summary["verdict"]["scale_95_pct"];
  EXPECT_LT(json::parse(metrics.out)["scale_error_pct"], scale_95_pct);
  EXPECT_LT(scale_95_pct, 1.0);  // 12 with the wrong rig
  const double infinity_sigma_px = summary["rig"]["infinity_offset_sigma_px"];
  EXPECT_NEAR(summary["rig"]["infinity_offset_px"], 2.0, 3.0 * infinity_sigma_px);
  EXPECT_LT(infinity_sigma_px, 0.03);
  // With the pool of itself alone it begins as it did before.
  const fs::path rig_out = folder_.Path() / "pooled.yaml", again = folder_.Path() / "again";
  const ProgramEnd pooled = RunRigmap({"calibrate", out_, "--rig-out", rig_out});
  EXPECT_EQ(pooled.exit_code, 0) << pooled.err;
  EXPECT_THAT(pooled.out, testing::HasSubstr(out_.string()));
  EXPECT_TRUE(ReadRigFile(rig_out).calibration_covariance);
  const auto run_with = [&](const fs::path& file) {
    const ProgramEnd with_it = RunRigmap(
        {"part", "--dataset", data, "--rig", file, "--out", again, "--until", "adjustment"});
    EXPECT_EQ(with_it.exit_code, 0) << with_it.err;
    return JsonOf(again / "summary.json")["rig"];
  };
  EXPECT_NEAR(run_with(rig_out)["infinity_offset_px"], 2.0, 0.1);
  // With the rig that it tells, and no word of which part told it, it has nothing to correct.
  WriteTestFile(rig_out, WriteRigFile(ReadRigFile(rig_out)));
  EXPECT_EQ(run_with(rig_out)["refined"], false);
  // Left to its own again, nothing of the corrected rig is left.
  RunRigmap(held);
  EXPECT_FALSE(fs::exists(out_ / "rig_refined.yaml"));
}

TEST_F(SimulatedPartTest, WithoutColmapFailsBeforeAnyWork) {
  const ProgramEnd end = RunProgram("env", {"PATH=/nowhere", RIGMAP_PROGRAM, "part", "--dataset",
                                            SimulatedPartFolder(), "--out", out_});
  EXPECT_EQ(end.exit_code, 1);
  EXPECT_THAT(end.LastErrorLine(), testing::HasSubstr("colmap"));
  EXPECT_FALSE(fs::exists(out_ / "stages"));
  EXPECT_EQ(JsonOf(out_ / "summary.json")["status"], "failed");
}

// Fewer than three keyframes: nothing to map, but every frame has a pose and there is a surface.
TEST_F(SimulatedPartTest, OfOneOrTwoPairsIsStillWhole) {
  for (const char* frames : {"0:1", "2:4"}) {
    RunPart(out_, {"--frames", frames, "--force"});
    const json summary = JsonOf(out_ / "summary.json");
    EXPECT_EQ(summary["frames"]["posed"], summary["frames"]["paired"]);
    EXPECT_GT(ReadPly(out_ / "dense.ply").size(), 1000U) << frames;
    EXPECT_TRUE(fs::exists(out_ / "sparse" / "images.bin"));
  }
}

}  // namespace
}  // namespace rigmap
