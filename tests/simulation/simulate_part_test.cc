// A whole simulated part as files: what a user gets, and what reads it.
#include "simulation/simulate_part.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <set>

#include "core/file.h"
#include "core/job.h"
#include "dataset/open_dataset.h"
#include "dataset/rig_file.h"
#include "export/tum.h"
#include "simulation/boulders.h"
#include "simulation/drive.h"
#include "simulation/scaled_rig.h"
#include "simulation/world.h"
#include "tests/support/synthetic_rover.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// Ten pairs of 160 x 120; five of them are spoilt, each in its own way.
SimulationRequest SmallRequest() {
  SimulationRequest request;
  request.pairs = 10;
  request.seed = 5;
  request.rig = Scaled(LocCamRig(), 0.15625);
  request.sand_cell_m = 0.1;
  request.depth_every = 5;
  request.markers = 3;
  request.faults = {"dropped=2:3", "lone-left=3:4", "lone-right=4:5", "black=5:6", "truncated=6:7"};
  return request;
}

std::map<std::string, std::string> BytesIn(const fs::path& folder) {
  std::map<std::string, std::string> bytes;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    bytes[entry.path().lexically_relative(folder).string()] = ReadTextFile(entry.path());
  }
  return bytes;
}

void SimulateWithThreads(int threads, const fs::path& folder) {
  Job(threads, true).Run([&] { SimulatePart(SmallRequest(), folder); });
}

class SimulatedFiles : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    SimulateWithThreads(2, folder_->Path() / "two");
  }
  static void TearDownTestSuite() { delete folder_; }

  static fs::path Out() { return folder_->Path() / "two"; }
  static fs::path Part() { return Out() / "data" / "Traverse3" / "Part1"; }
  static fs::path Truth() { return Out() / "truth" / "Part1"; }

  static Dataset Open() {
    DatasetRequest request;
    request.folder = Out() / "data";
    return OpenDataset(request);
  }

  static inline TemporaryFolder* folder_ = nullptr;
};

TEST_F(SimulatedFiles, BytesDoNotDependOnTheThreads) {
  SimulateWithThreads(1, folder_->Path() / "one");
  const auto one = BytesIn(folder_->Path() / "one"), two = BytesIn(Out());
  EXPECT_EQ(one.size(), two.size());
  for (const auto& [name, bytes] : one) {
    ASSERT_TRUE(two.contains(name)) << name;
    EXPECT_TRUE(two.at(name) == bytes) << name;
  }
}

TEST_F(SimulatedFiles, DatasetReadsThemWithTheFaultsAskedFor) {
  const Dataset dataset = Open();
  EXPECT_EQ(dataset.format, DatasetFormat::kKatwijk);
  EXPECT_EQ(dataset.frames.size(), 10u - 3u);  // without dropped and lone (2)
  EXPECT_EQ(dataset.health.images_read, 2 * 10 - 2 - 2);
  EXPECT_EQ(dataset.health.lone_images.size(), 2u);
  ASSERT_EQ(dataset.health.unreadable_images.size(), 1u);
  EXPECT_EQ(dataset.inclinometer.size(), dataset.frames.size());
  EXPECT_TRUE(dataset.truth_path.empty());
  int black = 0;
  const std::string& cut_off = dataset.health.unreadable_images.front();
  for (const StereoFrame& frame : dataset.frames) {
    if (frame.left_path == cut_off || frame.right_path == cut_off) continue;
    const cv::Mat left = cv::imread(frame.left_path, cv::IMREAD_UNCHANGED),
                  right = cv::imread(frame.right_path, cv::IMREAD_UNCHANGED);
    ASSERT_EQ(left.type(), CV_8UC3);
    ASSERT_EQ(left.size(), cv::Size(160, 120));
    ASSERT_EQ(right.size(), left.size());
    EXPECT_NE(cv::norm(left, right, cv::NORM_INF), 0.0);
    const bool is_black = cv::mean(left)[1] < 2.0;
    EXPECT_EQ(cv::mean(right)[1] < 2.0, is_black);
    EXPECT_TRUE(is_black || cv::mean(left)[1] > 60.0);
    black += is_black;
  }
  EXPECT_EQ(black, 1);
}

TEST_F(SimulatedFiles, DataHoldNoTruthAndNothingUnexpected) {
  std::set<std::string> others;
  int images = 0;
  for (const auto& [name, bytes] : BytesIn(Out() / "data")) {
    if (name.starts_with("Traverse3/Part1/LocCam/LocCam_2015_11_26_") && name.ends_with(".png")) {
      ++images;
    } else {
      others.insert(name);
    }
  }
  EXPECT_EQ(images, 16);
  const std::string rocks = "Rock Data/Rock Positions Traverse 3/";
  EXPECT_THAT(others, testing::ElementsAre(
                          rocks + "large-rocks-traverse3.txt", rocks + "medium-rocks-traverse3.txt",
                          rocks + "small-rocks-traverse3.txt", "Traverse3/Part1/gps-latlong.txt",
                          "Traverse3/Part1/gps-utm31.txt", "Traverse3/Part1/imu.txt",
                          "Traverse3/Part1/odometry.txt", "rig.yaml"));
}

TEST_F(SimulatedFiles, RigFileIsTheRig) {
  const StereoRig rig = SmallRequest().rig, read = ReadRigFile(Out() / "data" / "rig.yaml");
  for (const Eye eye : kEyes) {
    const Camera &a = read.Of(eye).camera, &b = rig.Of(eye).camera;
    EXPECT_EQ(std::tie(a.width, a.height, a.fx, a.fy, a.cx, a.cy, a.k1, a.k2, a.p1, a.p2),
              std::tie(b.width, b.height, b.fx, b.fy, b.cx, b.cy, b.k1, b.k2, b.p1, b.p2));
  }
  EXPECT_EQ(read.right_from_left.translation, rig.right_from_left.translation);
  EXPECT_LT(AngleOf(read.right_from_left.rotation * rig.right_from_left.rotation.conjugate()),
            1e-9);
  const RoverMount mount = MountOf(rig);
  ASSERT_TRUE(read.antenna_in_left && read.imu_from_left);
  EXPECT_LT((*read.antenna_in_left - mount.antenna_in_left).norm(), 1e-9);
  EXPECT_LT((read.imu_from_left->translation - mount.imu_from_left.translation).norm(), 1e-9);
}

TEST_F(SimulatedFiles, TruthKnowsThePosesOfAllPairs) {
  const auto truth = ReadTum(Truth() / "trajectory.tum");
  const Dataset dataset = Open();
  EXPECT_EQ(truth.size(), 7u);  // those read, and the one whose file ends early
  for (const StereoFrame& frame : dataset.frames) {
    EXPECT_TRUE(std::ranges::any_of(
        truth, [&](const TumPose& pose) { return pose.stamp_ns == frame.stamp_ns; }));
  }
  const double length_m =
      (truth.back().world_from_body.translation - truth.front().world_from_body.translation).norm();
  EXPECT_NEAR(length_m, 0.2 * 8.75, 0.08);  // 1.1 m up the cameras sway as the body tilts
}

// In axes of IMU and body: what the inclinometer feels is the slope of the true poses.
TEST_F(SimulatedFiles, InclinometerAgreesWithTheTrueSlope) {
  const auto truth = ReadTum(Truth() / "trajectory.tum");
  const Dataset dataset = Open();
  int checked = 0;
  for (const InclinometerSample& sample : dataset.inclinometer) {
    for (const TumPose& pose : truth) {
      if (pose.stamp_ns != sample.stamp_ns) continue;
      const Rigid3 world_from_imu = pose.world_from_body * dataset.rig.imu_from_left->Inverse();
      const Eigen::Vector3d up = world_from_imu.rotation * sample.acceleration_in_imu.normalized();
      EXPECT_LT(std::acos(std::min(1.0, up.z())), 0.06);  // rad; starts and stops are felt
      ++checked;
    }
  }
  EXPECT_GE(checked, 4);
}

TEST_F(SimulatedFiles, TruthIsComplete) {
  for (const char* name :
       {"surface.ply", "frames.txt", "antenna_at_frames.txt", "bloom.txt", "truth.json",
        "depth/camera.json", "depth/depth_0000.png", "depth/depth_0005.png"}) {
    EXPECT_TRUE(fs::is_regular_file(Truth() / name)) << name;
  }
  EXPECT_FALSE(fs::exists(Truth() / "depth" / "depth_0001.png"));
  EXPECT_TRUE(fs::is_regular_file(Out() / "truth" / "rocks.json"));
  const auto markers = nlohmann::json::parse(ReadTextFile(Out() / "truth" / "markers.json"));
  EXPECT_EQ(markers["centres"].size(), 3u);
  EXPECT_EQ(markers["radius_m"], World::kMarkerRadius_m);
}

TEST_F(SimulatedFiles, RocksFilesNameTheBouldersOfTheTruth) {
  std::size_t rows = 0;
  for (const auto& [name, text] : BytesIn(Out() / "data" / "Rock Data")) {
    rows += static_cast<std::size_t>(std::ranges::count(text, '\n'));
  }
  const DrivePlan plan = PlanDrive(SmallRequest());
  const Terrain terrain(plan.scene.terrain);
  const auto outline = plan.path.Outline(0.25);
  EXPECT_EQ(rows, ScatterBoulders(terrain, outline, plan.scene.boulders_per_100_m2, 5).size());
  EXPECT_GT(rows, 0u);
}

}  // namespace
}  // namespace rigmap
