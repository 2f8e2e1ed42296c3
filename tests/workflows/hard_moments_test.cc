// The hard moments of a drive, each on a small simulated part: what must come out of them, or else
// be refused.
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/file.h"
#include "dataset/rig_file.h"
#include "evaluation/trajectory_metrics.h"
#include "simulation/scaled_rig.h"
#include "simulation/simulate_part.h"
#include "tests/support/simulated_part.h"
#include "tests/support/temporary_folder.h"
#include "tests/workflows/rigmap_program.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct HardMoment {
  std::string name;
  std::string scene = "beach", path = "straight";
  std::vector<std::string> faults = {};
  double spacing_m = 0.2, contrast = 2.5;
  std::size_t paired = 12;                  // of the frames, those that have both eyes
  std::optional<std::size_t> bridged = {};  // the paired frame that shows nothing
};

std::ostream& operator<<(std::ostream& stream, const HardMoment& moment) {
  return stream << moment.name;
}

// Twelve pairs of a rig with a tenth of LocCam's pixels; more contrast and a coarser mesh for their
// sake.
SimulationRequest Request(const HardMoment& moment) {
  SimulationRequest request;
  request.scene = moment.scene;
  request.path = moment.path;
  request.faults = moment.faults;
  request.pairs = 12;
  request.seed = 7;
  request.rig = SmallRoverRig();
  request.spacing_m = moment.spacing_m;
  request.contrast = moment.contrast;
  request.sand_cell_m = 0.03;
  request.depth_every = 1000;
  return request;
}

class HardMoments : public testing::TestWithParam<HardMoment> {
 protected:
  void SetUp() override {
    SimulatePart(Request(GetParam()), folder_.Path());
    // Twelve small frames do not tell the calibration much better than its prior.
    const ProgramEnd end = RunRigmap({"part", "--dataset", folder_.Path() / "data", "--out", out_,
                                      "--until", "adjustment", "--accuracy", "2", "--quiet"});
    EXPECT_EQ(end.exit_code, 0) << end.err;
    EXPECT_EQ(end.err, "");
    ASSERT_TRUE(fs::exists(out_ / "trajectory.tum"));
    poses_ = ReadTum(out_ / "trajectory.tum");
    truth_ = ReadTum(folder_.Path() / "truth" / "Part1" / "trajectory.tum");
  }

  bool IsBridged(std::size_t frame) const { return GetParam().bridged == frame; }

  void ExpectSummary() const {
    const json summary = json::parse(ReadTextFile(out_ / "summary.json"));
    EXPECT_EQ(summary["status"], "ok") << summary["reason"];
    EXPECT_EQ(summary["frames"]["paired"], GetParam().paired);
    EXPECT_EQ(summary["frames"]["posed"], GetParam().paired);
    EXPECT_EQ(summary["frames"]["registered"], summary["frames"]["keyframes"]);
  }

  // Of the frames that show something. 3 mm would be enough; a scale error of 0.2 % would be a
  // defect.
  void ExpectCloseToTruth() const {
    std::vector<TumPose> usable;
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      if (!IsBridged(i)) usable.push_back(poses_[i]);
    }
    const TrajectoryMetrics metrics = CompareTrajectories(usable, truth_);
    ASSERT_TRUE(metrics.aligned);
    RecordProperty("ate_mm", std::to_string(1000.0 * metrics.aligned->ate_se3_m));
    RecordProperty("path_m", std::to_string(metrics.true_path_m));
    RecordProperty("scale", std::to_string(metrics.aligned->scale.value_or(1.0)));
    EXPECT_LT(metrics.aligned->ate_se3_m, 0.002);
    if (metrics.extent_m > 0.5) {
      EXPECT_NEAR(metrics.aligned->scale.value(), 1.0, 0.002);
    }
  }

  // Its distance from a neighbour, by its own sigma.
  void ExpectBridgedWithinItsSigma(std::size_t frame) const {
    const std::size_t neighbour = frame > 0 ? frame - 1 : 1;
    const auto step_m = [&](const std::vector<TumPose>& path) {
      return (path[frame].world_from_body.translation - path[neighbour].world_from_body.translation)
          .norm();
    };
    const std::vector<double> row = RowOf(frame);
    const double sigma_m = Eigen::Vector3d(row[8], row[9], row[10]).norm();
    EXPECT_GT(sigma_m, 0.001);
    EXPECT_LT(sigma_m, 0.3);
    EXPECT_NEAR(step_m(poses_), step_m(truth_), 3.0 * sigma_m);
  }

  // Stamp, pose and sigmas of a frame in trajectory.csv.
  std::vector<double> RowOf(std::size_t frame) const {
    std::istringstream lines(ReadTextFile(out_ / "trajectory.csv"));
    std::string line, cell;
    for (std::size_t i = 0; i <= frame + 1; ++i) std::getline(lines, line);
    std::istringstream cells(line);
    std::vector<double> row;
    while (row.size() < 14 && std::getline(cells, cell, ',')) row.push_back(std::stod(cell));
    return row;
  }

  TemporaryFolder folder_;
  fs::path out_ = folder_.Path() / "out";
  std::vector<TumPose> poses_, truth_;
};

TEST_P(HardMoments, IsSurvived) {
  ASSERT_EQ(poses_.size(), GetParam().paired);
  ASSERT_EQ(truth_.size(), GetParam().paired);
  ExpectSummary();
  ExpectCloseToTruth();
  if (GetParam().bridged) ExpectBridgedWithinItsSigma(*GetParam().bridged);
}

const std::vector<HardMoment> kMoments{
    {.name = "FlatSand", .scene = "flat-sand"},
    {.name = "Glare", .faults = {"glare=3:9"}},
    {.name = "BlackFrame", .faults = {"black=6:7"}, .bridged = 6},
    {.name = "BlackFirstFrame", .faults = {"black=0:1"}, .bridged = 0},
    {.name = "FramesMissing", .faults = {"dropped=5:8"}, .paired = 9},
    {.name = "OneEyeMissing", .faults = {"lone-left=5:8"}, .paired = 9},
    {.name = "ExposureStep", .faults = {"exposure=6:12"}},
    {.name = "ShadowAndPerson", .faults = {"shadow=1", "person=1"}},
    {.name = "StopAndGo", .path = "stop-and-go"},
    {.name = "SpotTurn", .path = "spot-turn"},
    {.name = "Backwards", .path = "backwards"},
    {.name = "Loop", .path = "loop"},
};

void ExpectScaleAsStated(const fs::path& folder, const std::string& out) {
  const json summary = json::parse(ReadTextFile(folder / out / "summary.json"));
  const TrajectoryMetrics metrics =
      CompareTrajectories(ReadTum(folder / out / "trajectory.tum"),
                          ReadTum(folder / "truth" / "Part1" / "trajectory.tum"));
  ASSERT_TRUE(metrics.aligned);
  EXPECT_NEAR(metrics.aligned->scale.value(), 1.0,
              0.01 * summary["verdict"]["scale_95_pct"].get<double>());
}

// Hardly a keypoint of flat sand is found again at the next half metre, but its patch is there.
TEST(LongStepsOverFlatSand, AreBridgedByPatches) {
  const TemporaryFolder folder;
  SimulatePart(
      Request({.scene = "flat-sand", .path = "s-curve", .spacing_m = 0.5, .contrast = 1.0}),
      folder.Path());
  const auto run = [&](const std::string& share) {
    const fs::path out = folder.Path() / share;
    const ProgramEnd end =
        RunRigmap({"part", "--dataset", folder.Path() / "data", "--out", out, "--until",
                   "adjustment", "--set", "matching.carry_below_share=" + share, "--quiet"});
    EXPECT_TRUE(end.exit_code == 0 || end.exit_code == 3) << end.err;
    return json::parse(ReadTextFile(out / "summary.json"));
  };
  const json carried = run("0.1"), found_again = run("0");
  const auto matches = [](const json& summary) { return summary["matches"]["matches_median"]; };
  ASSERT_GE(matches(found_again), 8);
  EXPECT_GT(matches(carried), 2 * matches(found_again).get<int>());
  EXPECT_EQ(carried["status"], "ok") << carried["reason"];
  EXPECT_EQ(carried["frames"]["posed"], 12);
  const auto scale_95_pct = [](const json& summary) {
    return summary["verdict"]["scale_95_pct"].get<double>();
  };
  EXPECT_LT(scale_95_pct(carried), 0.9 * scale_95_pct(found_again));
  ExpectScaleAsStated(folder.Path(), "0.1");
}

// A loop of which two steps show nothing that keypoints find, with all between hanging on one of
// them by a few points: the steps that were searched for tell the way better.
TEST(LongStepsOverFlatSand, HoldWhatAFewPointsTie) {
  const TemporaryFolder folder;
  SimulationRequest request =
      Request({.scene = "flat-sand", .path = "loop", .spacing_m = 0.63, .contrast = 0.99});
  request.pairs = 23;
  request.seed = 112923;
  request.rig = Scaled(ReadRigFile(fs::path(RIGMAP_CONFIG) / "rigs" / "loccam.yaml"), 0.5);
  request.sand_cell_m = 0.01;
  SimulatePart(request, folder.Path());
  const ProgramEnd end = RunRigmap({"part", "--dataset", folder.Path() / "data", "--out",
                                    folder.Path() / "loop", "--until", "adjustment", "--quiet"});
  EXPECT_EQ(end.exit_code, 0) << end.err;
  ExpectScaleAsStated(folder.Path(), "loop");
}

INSTANTIATE_TEST_SUITE_P(Simulated, HardMoments, testing::ValuesIn(kMoments),
                         [](const auto& instance) { return instance.param.name; });

}  // namespace
}  // namespace rigmap
