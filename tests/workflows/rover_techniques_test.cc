// The techniques that use what the rover's wheels, gyro and inclinometer measure.
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/file.h"
#include "tests/support/temporary_folder.h"
#include "tests/workflows/rigmap_program.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AllOf;
using testing::AnyOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr double kMaxAte_pct = 1.0, kMaxLengthError_pct = 2.5;

double LengthError_pct(const json& metrics) {
  const double truth_m = metrics["path_m"], found_m = metrics["est_path_m"];
  return 100.0 * std::abs(found_m / truth_m - 1.0);
}

TEST(RoverTechniques, AStereoFolderHasNoWheels) {
  const TemporaryFolder folder;
  for (const char* technique : {"wheels", "filter"}) {
    const ProgramEnd end =
        RunRigmap({"part", "--dataset", SimulatedPartFolder(), "--out", folder.Path() / technique,
                   "--quiet", "--technique", technique});
    EXPECT_EQ(end.exit_code, 1);
    EXPECT_THAT(end.LastErrorLine(), HasSubstr("holds neither wheels nor an inertial unit"));
  }
}

// On the rendered Katwijk drive, where RIGMAP_DATA says.
class RoverOnTheBeach : public testing::Test {
 protected:
  void SetUp() override {
    const char* data = std::getenv("RIGMAP_DATA");
    if (!data) GTEST_SKIP() << "RIGMAP_DATA is not set";
    beach_ = fs::path(data) / "beach-dev";
  }
  ProgramEnd Run(const std::string& technique, const fs::path& dataset, const std::string& part,
                 const std::string& until) const {
    return RunRigmap({"part", "--dataset", dataset, "--traverse", "3", "--part", part, "--out",
                      out_, "--quiet", "--technique", technique, "--until", until});
  }
  json Metrics(const std::string& part) const {
    return json::parse(
        RunRigmap({"evaluate", out_, "--truth", beach_ / "truth" / ("Part" + part), "--json"}).out);
  }

  // Part 2 with its images and with other rows of its sensors.
  ProgramEnd RunWith(const std::string& file, const std::string& rows,
                     const std::string& technique = "wheels",
                     const std::string& until = "dead_reckoning") const {
    const fs::path part = folder_.Path() / "spoilt" / "Traverse3" / "Part2";
    const fs::path from = beach_ / "Traverse3" / "Part2";
    fs::remove_all(part);
    fs::create_directories(part);
    fs::create_directory_symlink(from / "LocCam", part / "LocCam");
    fs::copy_file(beach_ / "rig.yaml", part / "rig.yaml");
    for (const char* name : {"odometry.txt", "imu.txt"}) {
      if (name != file) fs::copy_file(from / name, part / name);
    }
    if (!rows.empty()) {
      WriteFileAtomically(part / file, [&](std::ostream& stream) { stream << rows; });
    }
    return Run(technique, folder_.Path() / "spoilt", "2", until);
  }
  // The rows of a file of part 2 as `change` leaves them; an empty one is left out.
  template <class Change>
  std::string Rows(const std::string& file, const Change& change) const {
    std::istringstream rows(ReadTextFile(beach_ / "Traverse3" / "Part2" / file));
    std::string row, text;
    for (int i = 0; std::getline(rows, row); ++i) {
      const std::string changed = change(i, row);
      if (!changed.empty()) text += changed + "\n";
    }
    return text;
  }

  fs::path beach_;
  TemporaryFolder folder_;
  fs::path out_ = folder_.Path() / "out";
};

TEST_F(RoverOnTheBeach, WheelsFollowTheWay) {
  for (const char* part : {"1", "2"}) {
    fs::remove_all(out_);
    const ProgramEnd end = Run("wheels", beach_, part, "dead_reckoning");
    ASSERT_EQ(end.exit_code, 0) << end.err;
    const json metrics = Metrics(part);
    EXPECT_EQ(metrics["coverage"], 1.0);
    EXPECT_LT(metrics["ate_se3_pct"].get<double>(), kMaxAte_pct);
    EXPECT_LT(LengthError_pct(metrics), kMaxLengthError_pct);
  }
}

TEST_F(RoverOnTheBeach, TheFilterIsAsGoodAsTheBetterOfItsInputs) {
  constexpr double kWorse = 1.1;
  std::map<std::string, double> ate_m;
  for (const auto& [technique, until] :
       {std::pair("wheels", "dead_reckoning"), std::pair("vo", "trajectory"),
        std::pair("klt", "trajectory"), std::pair("filter", "filter")}) {
    const ProgramEnd end = Run(technique, beach_, "2", until);
    // Without images nothing is judged before the features are there; with them nothing checks the
    // calibration.
    ASSERT_EQ(end.exit_code, technique == std::string("wheels") ? 0 : 3) << end.err;
    EXPECT_THAT(end.err, AnyOf(IsEmpty(), HasSubstr("not known of the rig's calibration")));
    ate_m[technique] = Metrics("2")["ate_se3_m"];
  }
  EXPECT_LT(ate_m["filter"], kWorse * std::min(ate_m["vo"], ate_m["wheels"]));
  // Corners that are followed from image to image are no worse than 0.05 % of these 5.2 m.
  EXPECT_LT(ate_m["klt"], 0.0026);
}

// All encoders are dead: the filter then follows them and refuses what the images tell.
TEST_F(RoverOnTheBeach, WheelsThatImagesContradictThroughoutAreNamed) {
  const std::string dead = Rows("odometry.txt", [](int, const std::string& row) {
    std::istringstream values(row);
    std::string stamp, value, zeros;
    values >> stamp;
    while (values >> value) zeros += " 0";
    return stamp + zeros;
  });
  const ProgramEnd end = RunWith("odometry.txt", dead, "filter", "filter");
  EXPECT_EQ(end.exit_code, 3);
  EXPECT_THAT(end.err, HasSubstr("images and wheels tell of different motions"));
}

TEST_F(RoverOnTheBeach, WhatDeadReckoningCannotPromiseIsNotTrusted) {
  const ProgramEnd end = RunRigmap({"part", "--dataset", beach_, "--traverse", "3", "--part", "2",
                                    "--out", out_, "--quiet", "--technique", "wheels", "--set",
                                    "dense.method=bm", "--set", "fusion.voxel_m=0.05"});
  EXPECT_EQ(end.exit_code, 3) << end.err;
  EXPECT_THAT(end.err, HasSubstr("gate position_95_pct"));
  EXPECT_TRUE(fs::exists(out_ / "dense.ply"));
  const json summary = json::parse(ReadTextFile(out_ / "summary.json"));
  EXPECT_EQ(summary["status"], "untrusted");
  const std::string verdict = summary["verdict"]["text"];
  EXPECT_THAT(verdict, EndsWith("by the wheels, the sigma of their radius and slip counted"));
  EXPECT_THAT(end.err, Not(HasSubstr("baseline")));
  EXPECT_EQ(summary["world_up"], "imu");
  EXPECT_GT(summary["rover"]["wheel_scale_sigma"].get<double>(), 0.01);
}

TEST_F(RoverOnTheBeach, BadInputIsRefusedInASentence) {
  const auto all = [](int, const std::string& row) { return row; };
  const auto refused = [&](const std::string& file, const std::string& rows) {
    const ProgramEnd end = RunWith(file, rows);
    EXPECT_EQ(end.exit_code, 1) << end.err;
    return end.LastErrorLine();
  };
  EXPECT_THAT(refused("odometry.txt", ""), HasSubstr("found no such file"));
  EXPECT_THAT(refused("imu.txt", ""), HasSubstr("found no such file"));
  EXPECT_THAT(refused("odometry.txt", Rows("odometry.txt",
                                           [](int i, const std::string& row) {
                                             return i > 200 && i < 260 ? "" : row;
                                           })),
              AllOf(HasSubstr("odometry.txt: expected rows at least every 0.5 s"),
                    HasSubstr("found none for 4.")));
  // A row of words or nan is left out: so many in a row are a gap.
  EXPECT_THAT(refused("imu.txt", Rows("imu.txt",
                                      [](int i, const std::string& row) {
                                        return i > 2000 && i < 2500 ? row + "nan" : row;
                                      })),
              HasSubstr("imu.txt: expected rows at least every 0.5 s"));
  EXPECT_THAT(refused("odometry.txt", Rows("odometry.txt", all) + Rows("odometry.txt", all)),
              HasSubstr("expected rising stamps"));
  // Each wheel's angle and rate.
  EXPECT_THAT(refused("odometry.txt", Rows("odometry.txt",
                                           [](int, const std::string& row) {
                                             std::istringstream words(row);
                                             std::string text, a, b;
                                             words >> text;
                                             for (int i = 0; i < 6; ++i) {
                                               std::string torque;
                                               words >> a >> b >> torque;
                                               text += " " + b + " " + a + " " + torque;
                                             }
                                             while (words >> a) text += " " + a;
                                             return text;
                                           })),
              HasSubstr("are columns exchanged?"));
  // The clock jumps by an hour, of stamps YYYY_MM_DD_hh_mm_ss_mmm.
  EXPECT_THAT(refused("odometry.txt", Rows("odometry.txt",
                                           [](int i, std::string row) {
                                             if (i >= 200) row[12] = '6';  // of 15
                                             return row;
                                           })),
              HasSubstr("odometry.txt: expected rows at least every 0.5 s"));
  EXPECT_THAT(refused("imu.txt", Rows("imu.txt",
                                      [](int, const std::string& row) {
                                        std::istringstream words(row);
                                        std::string stamp, a[9];
                                        words >> stamp;
                                        for (std::string& word : a) words >> word;
                                        return stamp + " " + a[6] + " " + a[7] + " " + a[8] + " " +
                                               a[3] + " " + a[4] + " " + a[5] + " " + a[3] + " " +
                                               a[4] + " " + a[5];
                                      })),
              HasSubstr("are columns exchanged?"));
}

// Without bursts of slip, and with one, in which the wheels turn up to 60 % too far.
class RoverOnASimulatedDrive : public testing::TestWithParam<const char*> {};

TEST_P(RoverOnASimulatedDrive, IsFollowedByItsWheelsAndBetterByTheFilter) {
  const TemporaryFolder folder;
  const fs::path drive = folder.Path() / "drive";
  std::vector<std::string> simulate{"--scene",      "flat-sand", "--path",        "s-curve",
                                    "--pairs",      "20",        "--spacing",     "0.25",
                                    "--seed",       "31",        "--image-scale", "0.4",
                                    "--no-surface", "--out",     drive,           "--quiet"};
  const std::string fault = GetParam();
  if (!fault.empty()) simulate.insert(simulate.end(), {"--fault", fault});
  ASSERT_EQ(RunProgram(RIGMAP_SIMULATE_PROGRAM, simulate).exit_code, 0);
  std::map<std::string, json> metrics;
  for (const auto& [technique, until] :
       {std::pair("wheels", "dead_reckoning"), std::pair("vo", "trajectory"),
        std::pair("filter", "filter")}) {
    const fs::path out = folder.Path() / technique;
    const ProgramEnd end = RunRigmap({"part", "--dataset", drive / "data", "--out", out, "--quiet",
                                      "--technique", technique, "--until", until});
    ASSERT_NE(end.exit_code, 1) << end.err;
    metrics[technique] = json::parse(
        RunRigmap({"evaluate", out, "--truth", drive / "truth" / "Part1", "--json"}).out);
    EXPECT_EQ(metrics[technique]["coverage"], 1.0) << technique;
  }
  const double wheels_m = metrics["wheels"]["ate_se3_m"], vo_m = metrics["vo"]["ate_se3_m"];
  EXPECT_LT(metrics["filter"]["ate_se3_m"].get<double>(), 1.1 * std::min(wheels_m, vo_m));
  if (fault.empty()) {
    EXPECT_LT(metrics["wheels"]["ate_se3_pct"].get<double>(), kMaxAte_pct);
    EXPECT_LT(LengthError_pct(metrics["wheels"]), kMaxLengthError_pct);
  } else {
    EXPECT_GT(LengthError_pct(metrics["wheels"]), kMaxLengthError_pct);
  }
}

INSTANTIATE_TEST_SUITE_P(WithAndWithoutSlip, RoverOnASimulatedDrive, testing::Values("", "slip=1"));

// Ten seconds of black images on a drive of which the truth is known.
TEST(RoverInTheDark, TheFilterBridgesTenSeconds) {
  const TemporaryFolder folder;
  const fs::path drive = folder.Path() / "drive", out = folder.Path() / "out";
  ASSERT_EQ(RunProgram(RIGMAP_SIMULATE_PROGRAM,
                       {"--scene", "beach", "--path", "s-curve", "--pairs", "24", "--spacing",
                        "0.25", "--seed", "3", "--image-scale", "0.4", "--fault", "black=10:18",
                        "--out", drive, "--quiet"})
                .exit_code,
            0);
  const ProgramEnd end = RunRigmap({"part", "--dataset", drive / "data", "--out", out, "--quiet",
                                    "--technique", "filter", "--until", "filter"});
  // Nothing checks the calibration, which is all that is against it.
  ASSERT_EQ(end.exit_code, 3) << end.err;
  EXPECT_THAT(end.err, HasSubstr("not known of the rig's calibration"));
  EXPECT_THAT(end.err, Not(HasSubstr("tell of different motions")));
  std::istringstream rows(ReadTextFile(out / "trajectory.tum"));
  std::istringstream truth(ReadTextFile(drive / "truth" / "Part1" / "trajectory.tum"));
  // Positions of the frames before and after, by lines without comments.
  const auto positions = [](std::istream& stream) {
    std::vector<Eigen::Vector3d> all;
    std::string line;
    while (std::getline(stream, line)) {
      if (line.starts_with("#")) continue;
      std::istringstream words(line);
      double stamp = 0.0;
      Eigen::Vector3d position;
      words >> stamp >> position.x() >> position.y() >> position.z();
      all.push_back(position);
    }
    return all;
  };
  const auto found = positions(rows), expected = positions(truth);
  ASSERT_EQ(found.size(), 24U);
  ASSERT_EQ(expected.size(), 24U);
  double way_m = 0.0;
  for (int i = 9; i < 18; ++i) way_m += (expected[i + 1] - expected[i]).norm();
  const double bridged_m = (found[18] - found[9]).norm();
  EXPECT_NEAR(bridged_m, (expected[18] - expected[9]).norm(), 0.04 * way_m);
  const json metrics =
      json::parse(RunRigmap({"evaluate", out, "--truth", drive / "truth" / "Part1", "--json"}).out);
  EXPECT_EQ(metrics["coverage"], 1.0);
  EXPECT_LT(metrics["ate_se3_m"].get<double>(), 0.04 * way_m);
}

// Six images of a drive are missing between two parts, which then see no ground in common.
TEST(RoverInTheDark, AGapBetweenTwoPartsIsBridged) {
  const TemporaryFolder folder;
  const fs::path drive = folder.Path() / "drive";
  ASSERT_EQ(
      RunProgram(RIGMAP_SIMULATE_PROGRAM,
                 {"--scene", "beach", "--path", "s-curve", "--pairs", "26", "--spacing", "0.63",
                  "--seed", "5", "--image-scale", "0.4", "--no-surface", "--out", drive, "--quiet"})
          .exit_code,
      0);
  const auto join = [&](const fs::path& out) {
    std::vector<std::string> arguments{"join"};
    for (const char* frames : {"0:10", "16:26"}) {
      const fs::path part = out.string() + "-" + std::string(frames, 2);
      const ProgramEnd end = RunRigmap({"part", "--dataset", drive / "data", "--frames", frames,
                                        "--until", "adjustment", "--out", part, "--quiet"});
      EXPECT_EQ(end.exit_code, 0) << end.err;
      arguments.push_back(part);
    }
    arguments.insert(arguments.end(), {"--until", "adjustment", "--out", out, "--quiet"});
    return RunRigmap(arguments);
  };
  const auto worlds = [](const fs::path& out) {
    return json::parse(ReadTextFile(out / "summary.json"))["worlds"].size();
  };
  const fs::path out = folder.Path() / "out", without = folder.Path() / "without";
  const ProgramEnd joined = join(out);
  EXPECT_EQ(joined.exit_code, 0) << joined.err;
  EXPECT_EQ(worlds(out), 1U);
  const json summary = json::parse(ReadTextFile(out / "summary.json"));
  EXPECT_THAT(summary["verdict"]["text"].get<std::string>(), HasSubstr("by wheels and gyro"));
  const json metrics =
      json::parse(RunRigmap({"evaluate", out, "--truth", drive / "truth" / "Part1", "--json"}).out);
  EXPECT_LT(metrics["ate_se3_m"], summary["verdict"]["position_95_m"]);
  EXPECT_LT(metrics["scale_error_pct"], summary["verdict"]["scale_95_pct"]);
  // Without wheels nothing ties them.
  for (const auto& entry : fs::recursive_directory_iterator(drive / "data")) {
    if (entry.path().filename() == "odometry.txt") fs::remove(entry.path());
  }
  EXPECT_EQ(join(without).exit_code, 3);
  EXPECT_EQ(worlds(without), 2U);
}

}  // namespace
}  // namespace rigmap
