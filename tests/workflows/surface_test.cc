// The map of a small simulated part, judged by its truth and by its survey.
#include <gmock/gmock.h>

#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "colmap/model_io.h"
#include "core/file.h"
#include "core/statistics.h"
#include "evaluation/point_tree.h"
#include "export/ply.h"
#include "export/ply_reader.h"
#include "tests/support/temporary_folder.h"
#include "tests/workflows/rigmap_program.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// Fourteen pairs of half size past rocks, with a receiver whose clock is 0.4 s off.
class SurfaceOfASimulatedPart : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    const ProgramEnd simulated =
        RunProgram(RIGMAP_SIMULATE_PROGRAM,
                   {"--scene",        "rocks", "--path",        "s-curve",
                    "--pairs",        "14",    "--spacing",     "0.2",
                    "--seed",         "2",     "--image-scale", "0.5",
                    "--clock-offset", "0.4",   "--interval",    "1.8",
                    "--depth-every",  "1000",  "--out",         folder_->Path() / "simulated",
                    "--quiet"});
    ASSERT_EQ(simulated.exit_code, 0) << simulated.err;
    const ProgramEnd end = Run({});
    ASSERT_EQ(end.exit_code, 0) << end.err;
  }
  static void TearDownTestSuite() { delete folder_; }

  static ProgramEnd Run(const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"part",  "--dataset", folder_->Path() / "simulated" / "data",
                                       "--out", Out(),       "--truth",
                                       Truth(), "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunRigmap(arguments);
  }
  static fs::path Out() { return folder_->Path() / "out"; }
  static fs::path Truth() { return folder_->Path() / "simulated" / "truth" / "Part1"; }
  static json Evaluation() { return json::parse(ReadTextFile(Out() / "evaluation.json")); }

  inline static TemporaryFolder* folder_ = nullptr;
};

TEST_F(SurfaceOfASimulatedPart, IsCloseToTheTruth) {
  const json map = Evaluation()["map"];
  EXPECT_GT(map["within_1.5m"]["f_1cm"].get<double>(), 0.96);
  EXPECT_GT(map["within_2.5m"]["f_1cm"].get<double>(), 0.92);
  EXPECT_LT(map["within_1.5m"]["accuracy_median_mm"].get<double>(), 3.5);
  EXPECT_LT(map["within_3.5m"]["stray_over_20cm_pct"].get<double>(), 0.01);
  const json rocks = Evaluation()["rocks"];
  EXPECT_GE(rocks["rocks"], 2);
  EXPECT_EQ(rocks["found"], rocks["rocks"]);
  EXPECT_LT(rocks["shift_max_mm"].get<double>(), 10.0);
}

TEST_F(SurfaceOfASimulatedPart, StatesWhatItIsMadeOf) {
  const json map = json::parse(ReadTextFile(Out() / "summary.json"))["map"];
  const std::string header = ReadTextFile(Out() / "dense.ply").substr(0, 200);
  EXPECT_THAT(header, testing::HasSubstr("element vertex " +
                                         std::to_string(map["points"].get<std::size_t>()) + "\n"));
  EXPECT_GE(map["frames"], 7);
  EXPECT_LE(map["frames"], 14);
  EXPECT_GT(map["voxel_m"].get<double>(), 0.001);
  EXPECT_LT(map["voxel_m"].get<double>(), 0.05);
  EXPECT_EQ(map["max_sigma_pct"], 2.0);
  EXPECT_TRUE(map["max_sigma_m"].is_null());
}

TEST_F(SurfaceOfASimulatedPart, HasItsDisparitiesWithoutBias) {
  const json summary = json::parse(ReadTextFile(Out() / "summary.json"));
  for (const json& gate : summary["gates"]) {
    if (gate["name"] == "depth_bias_px") {
      EXPECT_LT(gate["value"].get<double>(), 0.03);
      return;
    }
  }
  ADD_FAILURE() << "no gate depth_bias_px";
}

TEST_F(SurfaceOfASimulatedPart, IsJudgedTheSameByEvaluate) {
  const ProgramEnd end = RunRigmap({"evaluate", Out(), "--truth", Truth(), "--json"});
  ASSERT_EQ(end.exit_code, 0) << end.err;
  const json again = json::parse(end.out);
  EXPECT_EQ(again["map"], Evaluation()["map"]);
  EXPECT_EQ(again["rocks"], Evaluation()["rocks"]);
}

TEST_F(SurfaceOfASimulatedPart, HasRocksThatAnotherScorerJudgesAlike) {
  const char* data = std::getenv("RIGMAP_DATA");
  const fs::path scorer = fs::path(data ? data : "") / ".." / "score" / "rock_fit.py";
  if (!data || !fs::exists(scorer) || !fs::exists(kPython)) {
    GTEST_SKIP() << "RIGMAP_DATA, the scorer beside it or Debian's python3 is missing";
  }
  const ProgramEnd scored =
      RunProgram(kPython, {scorer, Out() / "dense.ply", Out() / "trajectory.tum", Truth()});
  ASSERT_EQ(scored.exit_code, 0) << scored.err;
  EXPECT_EQ(Evaluation()["rocks"], json::parse(scored.out));
}

TEST_F(SurfaceOfASimulatedPart, IsLaidOnItsFixesAndSurvey) {
  const json rtk = Evaluation()["rtk"];
  EXPECT_NEAR(rtk["clock_offset_s"].get<double>(), 0.4,
              3.0 * rtk["clock_offset_sigma_s"].get<double>());
  EXPECT_LT(rtk["rms_residual_m"].get<double>(), 0.02);
  const json rocks = Evaluation()["surveyed_rocks"];
  EXPECT_GE(rocks["expected"], 2);
  EXPECT_EQ(rocks["found"], rocks["expected"]);
  for (const json& rock : rocks["each"]) {
    EXPECT_LE(rock["distance_m"].get<double>(), rock["limit_m"].get<double>());
  }
}

// GDAL's own tools, at the right place on Earth: Katwijk, 52.21 N, 4.40 E.
void ExpectRastersAtKatwijk(const fs::path& out) {
  const std::map<std::string, std::vector<std::string>> bands{
      {"height.tif", {"height", "sigma", "count", "view_angle"}},
      {"ortho.tif", {"red", "green", "blue", "alpha"}},
      {"terrain.tif", {"slope", "roughness", "step_height", "slope_exceeds_limit"}}};
  for (const auto& [name, expected] : bands) {
    const ProgramEnd end = RunProgram("gdalinfo", {"-json", out / name});
    ASSERT_EQ(end.exit_code, 0) << end.err;
    const json info = json::parse(end.out);
    std::vector<std::string> found;
    for (const json& band : info["bands"]) found.push_back(band["description"]);
    EXPECT_EQ(found, expected);
    EXPECT_THAT(info["coordinateSystem"]["wkt"].get<std::string>(),
                testing::HasSubstr("ID[\"EPSG\",32631]"));
    for (const json& corner : info["wgs84Extent"]["coordinates"][0]) {
      EXPECT_NEAR(corner[0], 4.40, 0.01);  // degrees east
      EXPECT_NEAR(corner[1], 52.21, 0.01);
    }
  }
}

void ExpectRoutesAtKatwijk(const fs::path& out) {
  for (const char* name : {"route.geojson", "route.kml"}) {
    const ProgramEnd end = RunProgram("ogrinfo", {"-al", "-so", out / name});
    ASSERT_EQ(end.exit_code, 0) << end.err;
    EXPECT_THAT(end.out, testing::ContainsRegex("Extent: \\(4.40[0-9]+, 52.21[0-9]+\\)")) << name;
  }
}

TEST_F(SurfaceOfASimulatedPart, LiesOnTheEarthWhereItsFixesSay) {
  const json sidecar = json::parse(ReadTextFile(Out() / "georeference.json"));
  EXPECT_EQ(sidecar["epsg"], 32631);
  EXPECT_LT(sidecar["sigma"]["horizontal_m"], 0.05);
  ExpectRastersAtKatwijk(Out());
}

// Cut in two, tied by the frames that both have and by its fixes.
TEST_F(SurfaceOfASimulatedPart, IsTheSameJoinedOfPartsAndTiedToItsFixes) {
  const fs::path joined = folder_->Path() / "joined";
  const auto run = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{
        "run",       "--dataset",  folder_->Path() / "simulated" / "data",
        "--split",   "2",          "--overlap",
        "4",         "--accuracy", "2",
        "--use-rtk", "--truth",    folder_->Path() / "simulated" / "truth",
        "--out",     joined,       "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunRigmap(arguments);
  };
  const ProgramEnd poses = run({"--until", "rtk"});  // and then the rest
  ASSERT_EQ(poses.exit_code, 0) << poses.err;
  const std::string trajectory = ReadTextFile(joined / "trajectory.tum");
  EXPECT_FALSE(fs::exists(joined / "dense.ply"));
  EXPECT_FALSE(fs::exists(joined / "parts" / "1.1" / "dense.ply"));
  const ProgramEnd end = run({});
  ASSERT_EQ(end.exit_code, 0) << end.err;
  EXPECT_EQ(ReadTextFile(joined / "trajectory.tum"), trajectory);
  const json use = json::parse(ReadTextFile(joined / "summary.json"))["rtk_use"];
  EXPECT_GE(use["tying"].get<int>() + use["judging"].get<int>(), 9);
  // Some ten fixes good to some millimetres cannot better a path good to tenths of one.
  EXPECT_LT(use.at("judging_gain_sigmas"), 2.0) << use;
  EXPECT_FALSE(use["used"]);

  const json evaluation = json::parse(ReadTextFile(joined / "evaluation.json"));
  EXPECT_LT(evaluation["ate_se3_m"], 0.001);  // over 2.6 m
  EXPECT_GT(evaluation["map"]["within_1.5m"]["f_1cm"].get<double>(), 0.96);
  EXPECT_EQ(evaluation["surveyed_rocks"]["found"], evaluation["surveyed_rocks"]["expected"]);
  EXPECT_GE(evaluation["surveyed_rocks"]["expected"], 2);
  ExpectRastersAtKatwijk(joined);
  ExpectRoutesAtKatwijk(joined);
  const ProgramEnd las = RunProgram(kPython, {RIGMAP_LAS_READER, joined / "dense.las"});
  ASSERT_EQ(las.exit_code, 0) << las.err;
  EXPECT_EQ(json::parse(las.out)["count"], ReadPly(joined / "dense.ply").size());
}

// By clouds alone: as the thesis chained them, and as well as they can be.
TEST_F(SurfaceOfASimulatedPart, HasRocksThatHoldChainedClouds) {
  const auto ate_pct = [&](const char* way) {
    const fs::path out = folder_->Path() / way;
    const ProgramEnd end = RunRigmap(
        {"part", "--dataset", folder_->Path() / "simulated" / "data", "--technique", "icp", "--set",
         std::string("registration.way=") + way, "--until", "trajectory", "--out", out, "--quiet"});
    EXPECT_EQ(end.exit_code, 3) << end.err;  // nothing checks the rig file
    const ProgramEnd judged = RunRigmap({"evaluate", out, "--truth", Truth(), "--json"});
    return json::parse(judged.out)["ate_se3_pct"].get<double>();
  };
  const auto gate = [&](const char* way, const char* name) {
    const json summary = json::parse(ReadTextFile(folder_->Path() / way / "summary.json"));
    for (const json& each : summary["gates"]) {
      if (each["name"] == name) return each["passed"].get<bool>();
    }
    throw std::logic_error(name);
  };
  EXPECT_LT(ate_pct("improved"), 1.0);
  EXPECT_TRUE(gate("improved", "length_pct"));
  EXPECT_GT(ate_pct("plain"), 3.0);
  EXPECT_FALSE(gate("plain", "length_pct"));
}

TEST_F(SurfaceOfASimulatedPart, HasARouteThatMapsTake) {
  ExpectRoutesAtKatwijk(Out());
  // The first pose lies where the grid's coordinates of it say, by PROJ.
  std::istringstream csv(ReadTextFile(Out() / "trajectory_utm.csv"));
  std::string line;
  std::getline(csv, line);
  std::getline(csv, line);
  std::vector<std::string> fields;
  std::istringstream row(line);
  for (std::string field; std::getline(row, field, ',');) fields.push_back(field);
  const ProgramEnd end =
      RunProgram("sh", {"-c", "echo " + fields[1] + " " + fields[2] +
                                  " | gdaltransform -s_srs EPSG:32631 -t_srs EPSG:4326"});
  ASSERT_EQ(end.exit_code, 0) << end.err;
  std::istringstream degrees(end.out);
  double longitude_deg = 0.0, latitude_deg = 0.0;
  degrees >> longitude_deg >> latitude_deg;
  const json route = json::parse(ReadTextFile(Out() / "route.geojson"))["features"][0];
  EXPECT_NEAR(route["geometry"]["coordinates"][0][0], longitude_deg, 2e-9);
  EXPECT_NEAR(route["geometry"]["coordinates"][0][1], latitude_deg, 2e-9);
}

TEST_F(SurfaceOfASimulatedPart, HasALasFileOfTheSamePoints) {
  const ProgramEnd end = RunProgram(kPython, {RIGMAP_LAS_READER, Out() / "dense.las"});
  ASSERT_EQ(end.exit_code, 0) << end.err;
  const json las = json::parse(end.out);
  EXPECT_EQ(las["count"], ReadPly(Out() / "dense.ply").size());
  EXPECT_EQ(las["records"][1]["keys"]["3072"], 32631);
  EXPECT_NEAR(las["points"][0]["xyz"][0], 595700.0, 200.0);
  EXPECT_NEAR(las["points"][0]["xyz"][1], 5785800.0, 200.0);
}

TEST_F(SurfaceOfASimulatedPart, IsDrawnAndDrawnAgainWhereThatIsAskedFor) {
  const std::string before = ReadTextFile(Out() / "height.tif");
  for (const char* name : {"ortho.tif", "view_top.png", "view_side.png", "view_oblique.png"}) {
    EXPECT_GT(fs::file_size(Out() / name), 1000U) << name;
  }
  const std::string ply = ReadTextFile(Out() / "dense.ply");
  fs::remove(Out() / "height.tif");
  ASSERT_EQ(Run({}).exit_code, 0);
  EXPECT_EQ(ReadTextFile(Out() / "height.tif"), before);
  EXPECT_EQ(ReadTextFile(Out() / "dense.ply"), ply);
  for (const std::string& file : FilesIn(Out())) {
    EXPECT_THAT(file, testing::Not(testing::HasSubstr("scratch")));
    EXPECT_FALSE(IsTemporaryName(fs::path(file).filename())) << file;
  }
}

PointCloud PointsIn(const fs::path& ply) {
  PlyReader reader(ply);
  PointCloud points, block;
  while (reader.Read(block)) points.insert(points.end(), block.begin(), block.end());
  return points;
}

// Median over the points of one cloud of the distance to the nearest of another.
double MedianDistanceM(const PointCloud& from, const PointCloud& to) {
  std::vector<Eigen::Vector3f> positions;
  for (const SurfacePoint& point : to) positions.push_back(point.x_in_world);
  const PointTree<Eigen::Vector3f> tree{positions};
  std::vector<double> distances_m;
  for (const SurfacePoint& point : from) {
    distances_m.push_back(tree.Nearest(point.x_in_world.cast<double>(), 1e3)->distance);
  }
  return Median(std::move(distances_m));
}

TEST_F(SurfaceOfASimulatedPart, IsFoundAgainByColmapsFusion) {
  const ProgramEnd run = Run({"--depth-maps"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const fs::path workspace = Out() / "dense_workspace";
  const SparseModel model = ReadModel(workspace / "sparse");
  ASSERT_EQ(model.cameras.size(), 1U);
  EXPECT_GT(model.images.size(), 3U);
  EXPECT_GT(model.points.size(), 500U);
  for (const SparsePoint& point : model.points) {
    EXPECT_GE(point.track.size(), 2U);
    EXPECT_LT(point.error_px, 2.0);
  }
  const Camera& camera = model.cameras.front().camera;
  for (const SparseImage& image : model.images) {
    const cv::Mat view = cv::imread((workspace / "images" / image.name).string());
    EXPECT_EQ(view.size(), cv::Size(camera.width, camera.height));
    const std::string stamp = fs::path(image.name).stem();
    EXPECT_TRUE(fs::exists(Out() / "depth_maps" / (stamp + ".tif")));
  }
  const fs::path fused = folder_->Path() / "fused.ply";
  const ProgramEnd end = RunProgram(
      "colmap", {"stereo_fusion", "--workspace_path", workspace, "--output_path", fused});
  ASSERT_EQ(end.exit_code, 0) << end.err;
  const PointCloud points = PointsIn(fused), ours = PointsIn(Out() / "dense.ply");
  EXPECT_GT(points.size(), ours.size() / 4);
  const double voxel_m = ours.front().grain_m;
  EXPECT_LT(MedianDistanceM(points, ours), voxel_m);
  EXPECT_LT(MedianDistanceM(ours, points), 2.0 * voxel_m);
}

}  // namespace
}  // namespace rigmap
