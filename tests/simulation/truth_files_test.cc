#include "simulation/internal/truth_files.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "core/file.h"
#include "export/tum.h"
#include "georeference/utm_grid.h"
#include "tests/simulation/small_world.h"
#include "tests/support/seeded_random.h"
#include "tests/support/synthetic_rover.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

constexpr StampNs kMillisecond_ns = 1'000'000;

class TruthFiles : public testing::Test {
 protected:
  TruthFiles() {
    SeededRandom random;
    for (int i = 0; i < 12; ++i) {
      frames_.push_back({.index = 2 * i,
                         .stamp_ns = (1448551418849 + 1151 * i) * kMillisecond_ns,
                         .world_from_left = random.Motion(30.0),
                         .travelled_m = 0.2 * i,
                         .glare_area = 0.3 * (i % 2),
                         .saturated_left = 0.01 * i,
                         .saturated_right = 0.02 * i});
    }
    setting_.rig = LocCamRig();
    setting_.rig.antenna_in_left = Eigen::Vector3d(0.027, -0.786, -0.888);
    setting_.mount = MountOf(setting_.rig);
    setting_.scene = MakeScene("rocks", 9);
    setting_.path = "s-curve";
    setting_.faults = {"dropped=3", "glare=0.5"};
    setting_.seed = 18446744073709551615u;
    setting_.gps_clock_offset_s = -0.35;
  }

  void Write() const { WriteTruthFiles(folder_.Path(), frames_, setting_, local_); }
  // The rows below the comment line.
  std::vector<std::vector<std::string>> Rows(const std::string& name) const {
    std::istringstream text(ReadTextFile(folder_.Path() / name));
    std::vector<std::vector<std::string>> rows;
    std::string line;
    std::getline(text, line);
    EXPECT_EQ(line.substr(0, 2), "# ");
    while (std::getline(text, line)) {
      std::istringstream words(line);
      rows.emplace_back(std::istream_iterator<std::string>(words),
                        std::istream_iterator<std::string>());
    }
    EXPECT_EQ(rows.size(), frames_.size());
    return rows;
  }
  nlohmann::json Json() const {
    return nlohmann::json::parse(ReadTextFile(folder_.Path() / "truth.json"));
  }

  const TemporaryFolder folder_;
  const LocalFrame local_{Geodetic{52.2141, 4.4004, 4.08}};
  std::vector<TruthFrame> frames_;
  TruthSetting setting_;
};

Eigen::Vector3d ToVector(const nlohmann::json& json) {
  return {json[0].get<double>(), json[1].get<double>(), json[2].get<double>()};
}

Eigen::Matrix4d ToMatrix(const nlohmann::json& json) {
  Eigen::Matrix4d matrix;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) matrix(i, j) = json[i][j].get<double>();
  }
  return matrix;
}

Eigen::Matrix4d ToMatrix(const Rigid3& b_from_a) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = b_from_a.rotation.toRotationMatrix();
  matrix.topRightCorner<3, 1>() = b_from_a.translation;
  return matrix;
}

TEST_F(TruthFiles, TrajectoryReadsBack) {
  Write();
  const auto poses = ReadTum(folder_.Path() / "trajectory.tum");
  ASSERT_EQ(poses.size(), frames_.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Rigid3 difference = poses[i].world_from_body.Inverse() * frames_[i].world_from_left;
    EXPECT_EQ(poses[i].stamp_ns, frames_[i].stamp_ns);
    EXPECT_LT(difference.translation.norm(), 2e-9);
    EXPECT_LT(AngleOf(difference.rotation), 1e-11);
  }
}

TEST_F(TruthFiles, StampsAreThoseOfTheImageNamesInAllFiles) {
  frames_[3].stamp_ns += 999'999;  // names are rounded down to milliseconds
  Write();
  const auto rows = Rows("frames.txt"), poses = Rows("trajectory.tum"),
             antenna = Rows("antenna_at_frames.txt");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i][0], std::to_string(frames_[i].index));
    EXPECT_EQ(rows[i][1], FormatKatwijkStamp(frames_[i].stamp_ns));
    EXPECT_EQ(ParseSeconds(rows[i][2]), ParseKatwijkStamp(rows[i][1]));
    EXPECT_EQ(rows[i][2], poses[i][0]);
    EXPECT_EQ(rows[i][2], antenna[i][0]);
    EXPECT_NEAR(std::stod(rows[i][3]), frames_[i].travelled_m, 5e-5);
  }
}

TEST_F(TruthFiles, AntennaIsWhereThePoseAndTheMapSay) {
  Write();
  const auto rows = Rows("antenna_at_frames.txt");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::vector<double> value;
    for (const std::string& word : rows[i]) value.push_back(std::stod(word));
    const Eigen::Vector3d expected = frames_[i].world_from_left * *setting_.rig.antenna_in_left;
    EXPECT_LT((Eigen::Vector3d(value[1], value[2], value[3]) - expected).norm(), 1e-6);
    const Geodetic position = FromUtm(kUtm31, value[4], value[5], value[6]);
    EXPECT_LT((local_.ToEnu(position) - expected).norm(), 2e-6);
  }
}

TEST_F(TruthFiles, BloomIsToldPerFrame) {
  Write();
  const auto rows = Rows("bloom.txt");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i][0], std::to_string(frames_[i].index));
    EXPECT_NEAR(std::stod(rows[i][1]), frames_[i].glare_area, 1e-9);
    EXPECT_NEAR(std::stod(rows[i][2]), frames_[i].saturated_left, 1e-9);
    EXPECT_NEAR(std::stod(rows[i][3]), frames_[i].saturated_right, 1e-9);
  }
}

TEST_F(TruthFiles, MountsAreConsistent) {
  Write();
  const auto json = Json();
  const Eigen::Matrix4d body_from_left = ToMatrix(json["body_T_leftcam"]);
  const Eigen::Vector3d antenna_in_left = ToVector(json["antenna_in_leftcam_m"]);
  const Eigen::Vector3d antenna_in_body = ToVector(json["antenna_body_flu_m"]);
  EXPECT_LT(
      ((body_from_left * antenna_in_left.homogeneous()).hnormalized() - antenna_in_body).norm(),
      1e-12);
  const Eigen::Matrix4d via_imu = ToMatrix(json["body_T_imu"]) * ToMatrix(json["imu_T_leftcam"]);
  EXPECT_LT((via_imu - body_from_left).norm(), 1e-9);
  const Eigen::Matrix4d there_and_back =
      ToMatrix(json["left_T_right"]) * ToMatrix(setting_.rig.right_from_left);
  EXPECT_LT((there_and_back - Eigen::Matrix4d::Identity()).norm(), 1e-12);
  EXPECT_EQ(json["imu_T"], "IMU at body (0,0,0.545), axes x backward y right z up");
}

TEST_F(TruthFiles, OriginAndConvergenceDescribeTheMap) {
  Write();
  const auto json = Json();
  EXPECT_EQ(json["origin_lat_lon_alt"][0], 52.2141);
  const double convergence_rad =
      json["grid_convergence_deg"].get<double>() * std::numbers::pi / 180.0;
  const UtmPoint north = ToUtm(kUtm31, local_.ToGeodetic({0.0, 1.0, 0.0}));
  const double east_m = north.easting_m - json["utm31_origin_easting"].get<double>();
  EXPECT_NEAR(east_m / north.scale, std::sin(convergence_rad), 1e-6);
  EXPECT_NEAR(json["grid_convergence_deg"].get<double>(), -1.1068277, 1e-6);
}

TEST_F(TruthFiles, RequestIsKept) {
  Write();
  const auto json = Json();
  EXPECT_EQ(json["seed"], setting_.seed);
  EXPECT_EQ(json["scene"], "rocks");
  EXPECT_EQ(json["path"], "s-curve");
  EXPECT_EQ(json["faults"], nlohmann::json(setting_.faults));
  EXPECT_EQ(json["gps_clock_offset_s"], -0.35);
  EXPECT_NEAR(ToVector(json["sun_direction_enu"]).norm(), 1.0, 1e-12);
}

TEST_F(TruthFiles, RocksAreThoseOfTheWorld) {
  const auto& boulders = SmallWorld().boulders();
  const auto outline = SmallOutline();
  WriteTruthRocks(folder_.Path() / "rocks.json", boulders, outline, local_);
  const auto json = nlohmann::json::parse(ReadTextFile(folder_.Path() / "rocks.json"));
  ASSERT_EQ(json["rocks"].size(), boulders.size());
  for (std::size_t i = 0; i < boulders.size(); ++i) {
    const auto& rock = json["rocks"][i];
    const Eigen::Vector3d centre(rock["x"].get<double>(), rock["y"].get<double>(),
                                 rock["z"].get<double>());
    EXPECT_EQ(rock["size"], boulders[i].size);
    EXPECT_EQ(rock["height"], boulders[i].height_m);
    EXPECT_EQ(rock["width"], boulders[i].width_m);
    EXPECT_EQ(rock["yaw_rad"], boulders[i].yaw_rad);
    EXPECT_EQ(centre, boulders[i].centre);
    EXPECT_EQ(ToVector(rock["top"]), boulders[i].top);
    const double off_end_m = centre.x() - std::clamp(centre.x(), 0.0, 2.0);
    EXPECT_NEAR(rock["path_dist"], std::hypot(off_end_m, centre.y()), 1e-9);
    const Geodetic position = FromUtm(kUtm31, rock["utm31_easting"], rock["utm31_northing"],
                                      local_.ToGeodetic(centre).altitude_m);
    EXPECT_LT((local_.ToEnu(position) - centre).norm(), 1e-6);
  }
}

}  // namespace
}  // namespace rigmap
