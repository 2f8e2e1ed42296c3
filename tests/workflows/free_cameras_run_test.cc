// The techniques sfm and combined on the simulated part: COLMAP alone, whose own figures do not
// tell that it is wrong, and clouds laid on its poses.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "core/file.h"
#include "tests/support/temporary_folder.h"
#include "tests/workflows/rigmap_program.h"

namespace rigmap {
namespace {

using nlohmann::json;
using testing::HasSubstr;

TEST(FreeCamerasRun, CountsTheFocalLengthsThatColmapChanged) {
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
  } else {
    EXPECT_LE(metrics["scale_error_pct"], stated);
  }
  EXPECT_EQ(metrics["frames"], 8);
}

TEST(FreeCamerasRun, CombinedLaysCloudsOnTheSamePoses) {
  const TemporaryFolder folder;
  const auto sfm = folder.Path() / "sfm", combined = folder.Path() / "combined";
  RunRigmap({"part", "--dataset", SimulatedPartFolder(), "--technique", "sfm", "--until",
             "trajectory", "--out", sfm, "--quiet"});
  // The same folder goes on, so that both have what COLMAP has drawn by chance.
  std::filesystem::copy(
      sfm, combined,
      std::filesystem::copy_options::recursive | std::filesystem::copy_options::copy_symlinks);
  const ProgramEnd end = RunRigmap({"part", "--dataset", SimulatedPartFolder(), "--technique",
                                    "combined", "--out", combined, "--quiet"});
  ASSERT_TRUE(end.exit_code == 0 || end.exit_code == 3) << end.err;
  EXPECT_EQ(ReadTextFile(combined / "trajectory.tum"), ReadTextFile(sfm / "trajectory.tum"));
  EXPECT_FALSE(std::filesystem::exists(sfm / "dense.ply"));
  const json summary = json::parse(ReadTextFile(combined / "summary.json"));
  EXPECT_EQ(summary["technique"], "combined");
  EXPECT_TRUE(summary["gates"].dump().find("depth_bias_px") != std::string::npos);
  EXPECT_TRUE(std::filesystem::exists(combined / "dense.ply"));
}

}  // namespace
}  // namespace rigmap
