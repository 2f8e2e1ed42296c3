// The techniques sfm and combined on the simulated part: COLMAP alone, whose own figures do not
// tell that it is wrong, and clouds laid on its poses.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "core/file.h"
#include "tests/support/temporary_folder.h"
#include "tests/workflows/rigmap_program.h"

namespace rigmap {
namespace {

using nlohmann::json;
using testing::HasSubstr;

// Rows of the trajectory; what is not trusted says so above them.
std::vector<std::string> PosesOf(const std::filesystem::path& out) {
  std::istringstream lines(ReadTextFile(out / "trajectory.tum"));
  std::vector<std::string> poses;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("#")) poses.push_back(line);
  }
  return poses;
}

TEST(FreeCamerasRun, CountsTheFocalLengthsThatColmapChangedAndTakesClouds) {
  const TemporaryFolder folder;
  const auto out = folder.Path() / "out";
  const ProgramEnd end =
      RunRigmap({"part", "--dataset", SimulatedPartFolder(), "--technique", "sfm", "--truth",
                 SimulatedPartFolder() / "groundtruth_tum.txt", "--out", out, "--quiet"});
  ASSERT_TRUE(end.exit_code == 0 || end.exit_code == 3) << end.err;  // COLMAP samples at random
  const json verdict = json::parse(ReadTextFile(out / "summary.json"))["verdict"];
  const json metrics = json::parse(ReadTextFile(out / "evaluation.json"));
  // Eight images along a line do not tell a focal length, and left-right distances not that: COLMAP
  // makes them 7 % longer or seven times as long, as chance has it.
  EXPECT_THAT(verdict["text"].get<std::string>(), HasSubstr("COLMAP's focal lengths"));
  const json& stated = verdict["scale_95_pct"];
  if (stated.is_null()) {
    EXPECT_EQ(end.exit_code, 3);
    EXPECT_THAT(verdict["text"].get<std::string>(), HasSubstr("of metres nothing is known"));
  } else if (!verdict["known"]["guessed"].empty()) {
    // Of images that COLMAP leaves out nothing is known: they lie where the last pose is, which
    // makes the way shorter. The stated figure is of the others.
    EXPECT_EQ(end.exit_code, 3);
    EXPECT_THAT(verdict["text"].get<std::string>(),
                HasSubstr("guessed, of which that says nothing"));
  } else {
    EXPECT_LE(metrics["scale_error_pct"], stated);
  }
  EXPECT_EQ(metrics["frames"], 8);
  EXPECT_FALSE(std::filesystem::exists(out / "dense.ply"));

  // The other technique goes on from what COLMAP has drawn by chance, and lays clouds on it.
  const std::vector<std::string> poses = PosesOf(out);
  EXPECT_EQ(poses.size(), 8U);
  const ProgramEnd combined = RunRigmap({"part", "--dataset", SimulatedPartFolder(), "--technique",
                                         "combined", "--out", out, "--quiet"});
  ASSERT_TRUE(combined.exit_code == 0 || combined.exit_code == 3) << combined.err;
  EXPECT_EQ(PosesOf(out), poses);
  const json summary = json::parse(ReadTextFile(out / "summary.json"));
  EXPECT_EQ(summary["technique"], "combined");
  EXPECT_THAT(summary["gates"].dump(), HasSubstr("depth_bias_px"));
  EXPECT_TRUE(std::filesystem::exists(out / "dense.ply"));
}

}  // namespace
}  // namespace rigmap
