// What a result folder holds, and what a later run makes of it.
#include <gmock/gmock.h>
#include <unistd.h>

#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/file.h"
#include "export/tum.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_file.h"
#include "tests/workflows/rigmap_program.h"
#include "workflows/reconstruct_part.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

using Arguments = std::vector<std::string>;

class ContinuedPart : public testing::Test {
 protected:
  // A whole result of the simulated part, made once.
  static void SetUpTestSuite() {
    made_ = new TemporaryFolder;
    data_ = CopyOfSimulatedPart(made_->Path());
    const ProgramEnd end = Run(RIGMAP_PROGRAM, made_->Path() / "out", data_);
    ASSERT_EQ(end.exit_code, 0) << end.err;
  }
  static void TearDownTestSuite() {
    delete made_;
    made_ = nullptr;
  }
  // A copy of it that a test may change.
  ContinuedPart() {
    fs::copy(made_->Path() / "out", out_,
             fs::copy_options::recursive | fs::copy_options::copy_symlinks);
  }

  static ProgramEnd Run(const fs::path& program, const fs::path& out, const fs::path& data,
                        const Arguments& more = {}) {
    Arguments arguments{"part", "--dataset", data, "--out", out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunProgram(program, arguments);
  }
  ProgramEnd Continue(const Arguments& more = {}) const {
    return Run(RIGMAP_PROGRAM, out_, data_, more);
  }
  json Summary() const { return json::parse(ReadTextFile(out_ / "summary.json")); }
  // Names of the stages that the last run made.
  Arguments Made() const {
    Arguments names;
    const json summary = Summary();
    for (const json& stage : summary["stages"]) {
      if (!stage["reused"]) names.push_back(stage["name"]);
    }
    return names;
  }
  // Every published file that tells nothing of time and reuse, with its bytes.
  std::map<std::string, std::string> Published() const {
    std::map<std::string, std::string> bytes;
    for (const std::string& name : FilesIn(out_)) {
      const fs::path path = out_ / name;
      if (!fs::is_regular_file(path) || name.starts_with("stages/") || name.starts_with("logs/") ||
          name == "summary.json" || name == "report.html") {
        continue;
      }
      bytes[name] = ReadTextFile(path);
    }
    return bytes;
  }

  // Names of what is published now and was not before, or the other way round, or has other bytes.
  Arguments DifferentFrom(const std::map<std::string, std::string>& before) const {
    const auto now = Published();
    Arguments names;
    for (const auto& [name, bytes] : now) {
      const auto old = before.find(name);
      if (old == before.end() || old->second != bytes) names.push_back(name);
    }
    for (const auto& [name, bytes] : before) {
      if (!now.contains(name)) names.push_back(name);
    }
    return names;
  }

  static TemporaryFolder* made_;
  static fs::path data_;
  TemporaryFolder folder_;
  fs::path out_ = folder_.Path() / "out";
};
TemporaryFolder* ContinuedPart::made_ = nullptr;
fs::path ContinuedPart::data_;

TEST_F(ContinuedPart, MovedWithItsDataIsDoneAlready) {
  const fs::path data = folder_.Path() / "elsewhere" / "data";
  fs::create_directories(data.parent_path());
  fs::copy(data_, data, fs::copy_options::recursive);  // with new times
  const auto before = Published();
  const ProgramEnd end = Run(RIGMAP_PROGRAM, out_, data);
  ASSERT_EQ(end.exit_code, 0) << end.err;
  EXPECT_THAT(Made(), IsEmpty());
  // Only where the images lie is told anew, for a join.
  EXPECT_THAT(DifferentFrom(before), ElementsAre("joining/input.bin"));
  const json summary = Summary();
  EXPECT_EQ(summary["stages"].size(), 20U);
  EXPECT_EQ(summary["gates"].size(), 23U);
  // Links lead to where the images are now.
  for (const auto& link : fs::directory_iterator(out_ / "colmap" / "images" / "left")) {
    EXPECT_THAT(fs::read_symlink(link.path()).string(), StartsWith(data.string()));
  }
}

TEST_F(ContinuedPart, WithAnotherAlgorithmIsDoneAnewFromThatStageOn) {
  const auto before = Published();
  ASSERT_EQ(Run(RIGMAP_OTHER_PROGRAM, out_, data_).exit_code, 0);
  EXPECT_THAT(Made(),
              ElementsAre("fusion", "georeference", "raster", "las", "views", "evaluation"));
  // Only the identity differs: the algorithm is the same.
  EXPECT_THAT(DifferentFrom(before), IsEmpty());
}

// As by a copy that was broken off.
TEST_F(ContinuedPart, WithADepthMapThatWasCutOffMakesThatAnew) {
  const auto before = Published();
  const fs::path cut = fs::directory_iterator(out_ / "stages" / "dense")->path();
  fs::resize_file(cut, 1000);
  fs::remove(out_ / "dense.ply");
  const ProgramEnd end = Continue();
  ASSERT_EQ(end.exit_code, 0) << end.err;
  EXPECT_GT(fs::file_size(cut), 1000U);
  // Its bias is of depths as stored, or of one as it was found, to a hundredth of a pixel.
  EXPECT_THAT(DifferentFrom(before), testing::IsSubsetOf({"joining/depths.bin"}));
}

TEST_F(ContinuedPart, SaysThatItsMapIsEmpty) {
  const ProgramEnd end = Continue({"--set", "fusion.min_observations=100000000"});
  EXPECT_EQ(end.exit_code, 0);
  EXPECT_THAT(end.err, HasSubstr("the map is empty"));
  EXPECT_THAT(Summary()["mapping"]["remarks"].dump(), HasSubstr("the map is empty"));
}

TEST_F(ContinuedPart, IsAskedForOneAccuracy) {
  const ProgramEnd end = Continue({"--accuracy", "2", "--set", "gates.accuracy_pct=0.1"});
  EXPECT_EQ(end.exit_code, 2);
  EXPECT_THAT(end.err, HasSubstr("--accuracy 2: expected no --set of the same"));
}

TEST_F(ContinuedPart, WithAnotherPictureSizeMakesPicturesOnly) {
  const std::string map = ReadTextFile(out_ / "dense.ply"),
                    picture = ReadTextFile(out_ / "view_top.png");
  ASSERT_EQ(Continue({"--set", "raster.picture_px=1000"}).exit_code, 0);
  EXPECT_THAT(Made(), ElementsAre("views"));
  EXPECT_TRUE(ReadTextFile(out_ / "dense.ply") == map);
  EXPECT_FALSE(ReadTextFile(out_ / "view_top.png") == picture);
}

// Nothing but what bears the verdict.
TEST_F(ContinuedPart, JudgedByOtherLimitsMakesNothingElseAnew) {
  const ProgramEnd end = Continue({"--set", "gates.epipolar_px=0.000001"});
  EXPECT_EQ(end.exit_code, 3);
  EXPECT_THAT(Made(), ElementsAre("georeference", "raster", "las", "views"));
  EXPECT_EQ(Summary()["status"], "untrusted");
  EXPECT_THAT(Summary()["reason"].get<std::string>(), HasSubstr("epipolar_px"));
}

TEST_F(ContinuedPart, SaysInEveryFileThatItIsNotTrustedAsLongAsItIsNot) {
  const auto trusted = Published();
  ASSERT_EQ(Continue({"--set", "gates.epipolar_px=0.000001"}).exit_code, 3);
  const std::string sentence = "not trusted: left and right images do not fit the rig file\n";
  for (const char* name : {"trajectory.tum", "trajectory_kitti.txt", "trajectory_midpoint.tum",
                           "steps/odometry.tum", "posegraph.g2o"}) {
    EXPECT_THAT(ReadTextFile(out_ / name), StartsWith("# " + sentence)) << name;
  }
  for (const char* name : {"dense.ply", "sparse.ply"}) {
    EXPECT_THAT(ReadTextFile(out_ / name).substr(0, 200), HasSubstr("\ncomment " + sentence));
  }
  for (const char* name : {"height.tif", "ortho.tif", "terrain.tif", "dense.las"}) {
    EXPECT_THAT(ReadTextFile(out_ / name), HasSubstr(sentence.substr(0, sentence.size() - 1)))
        << name;
  }
  const auto untrusted = Published();
  for (const char* name : {"view_top.png", "view_side.png", "view_oblique.png"}) {
    EXPECT_FALSE(untrusted.at(name) == trusted.at(name)) << name;
  }
  // What is removed or cut short comes back with it, and all of it goes with the reason.
  fs::remove(out_ / "trajectory.tum");
  fs::resize_file(out_ / "dense.ply", 100'000);
  fs::resize_file(out_ / "sparse" / "points3D.bin", 0);
  ASSERT_EQ(Continue({"--set", "gates.epipolar_px=0.000001"}).exit_code, 3);
  EXPECT_THAT(DifferentFrom(untrusted), IsEmpty());
  ASSERT_EQ(Continue({}).exit_code, 0);
  EXPECT_THAT(DifferentFrom(trusted), IsEmpty());
}

TEST_F(ContinuedPart, AskedToBeBetterThanItIsMakesNothingElseAnewAndSaysSo) {
  const double scale_95_pct = Summary()["verdict"]["scale_95_pct"];
  ASSERT_GT(scale_95_pct, 0.0);
  const ProgramEnd end = Continue({"--accuracy", std::to_string(0.5 * scale_95_pct)});
  EXPECT_EQ(end.exit_code, 3);
  EXPECT_THAT(end.LastErrorLine(), HasSubstr("gate scale_95_pct"));
  EXPECT_THAT(end.err, HasSubstr("rigmap: NOT TRUSTED: the scale is known to "));
  EXPECT_THAT(end.err, HasSubstr("rigmap: usable all the same: shape and path: metres to "));
  EXPECT_THAT(end.err, HasSubstr("rigmap: to try next: "));
  EXPECT_THAT(Made(), ElementsAre("georeference", "raster", "las", "views"));
  EXPECT_EQ(Summary()["status"], "untrusted");
  EXPECT_THAT(Summary()["verdict"]["text"].get<std::string>(),
              StartsWith("consistent, but not as good"));
  EXPECT_EQ(Continue({"--accuracy", "50"}).exit_code, 0);
}

TEST_F(ContinuedPart, WithoutAMappingEndsWithTheSamePoses) {
  const std::vector<TumPose> mapped = ReadTum(out_ / "trajectory.tum");
  const ProgramEnd end = Continue({"--set", "mapping.method=none", "--until", "steps"});
  ASSERT_EQ(end.exit_code, 0) << end.err;
  EXPECT_THAT(Made(), Not(testing::Contains("matching")));
  EXPECT_EQ(Summary()["mapping"]["method"], "none");
  EXPECT_TRUE(fs::exists(out_ / "steps" / "odometry.tum"));
  EXPECT_FALSE(fs::exists(out_ / "steps" / "mapping.tum"));
  const std::vector<TumPose> poses = ReadTum(out_ / "trajectory.tum");
  ASSERT_EQ(poses.size(), mapped.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_LT((poses[i].world_from_body.translation - mapped[i].world_from_body.translation).norm(),
              0.001)
        << i;
  }
}

TEST_F(ContinuedPart, SaysThatItsMetresRestOnTheBaseline) {
  EXPECT_THAT(Summary()["verdict"]["text"].get<std::string>(),
              testing::MatchesRegex("metres good to .* % and positions to .* \\(95 %\\); .*"
                                    "if the baseline is [0-9.]+ mm"));
  // Of one whose sigma the rig file states that counts in them.
  const fs::path data = CopyOfSimulatedPart(folder_.Path());
  const double stated = Summary()["verdict"]["scale_95_pct"];
  const std::string rig = ReadTextFile(data / "calib.yaml");
  WriteTestFile(data / "calib.yaml", rig + "sigmas: {baseline_m: 0.0012}\n");
  const fs::path out = folder_.Path() / "stated";
  ASSERT_NE(Run(RIGMAP_PROGRAM, out, data, {"--until", "adjustment"}).exit_code, 1);
  const json verdict = json::parse(ReadTextFile(out / "summary.json"))["verdict"];
  EXPECT_THAT(verdict["text"].get<std::string>(),
              testing::EndsWith("the baseline's sigma counted"));
  const double of_baseline = 1.960 * 100.0 * 0.0012 / verdict["known"]["baseline_m"].get<double>();
  EXPECT_NEAR(verdict["scale_95_pct"], std::hypot(stated, of_baseline), 0.05 * of_baseline);
}

TEST_F(ContinuedPart, OfOtherFramesIsRefusedAndNothingIsLost) {
  const auto before = Published();
  const std::string summary = ReadTextFile(out_ / "summary.json");
  const ProgramEnd end = Continue({"--frames", "0:6", "--until", "odometry"});
  EXPECT_EQ(end.exit_code, 1);
  EXPECT_THAT(end.LastErrorLine(), HasSubstr("other frames"));
  EXPECT_THAT(DifferentFrom(before), IsEmpty());
  EXPECT_EQ(ReadTextFile(out_ / "summary.json"), summary);
}

TEST_F(ContinuedPart, AskedForLessKeepsWhatHoldsAndSaysSo) {
  ASSERT_EQ(Continue({"--set", "gates.epipolar_px=0.000001"}).exit_code, 3);
  const auto before = Published();
  const ProgramEnd end = Continue({"--set", "gates.epipolar_px=0.000001", "--until", "odometry"});
  EXPECT_EQ(end.exit_code, 3) << end.err;  // what lies there is untrusted still
  EXPECT_EQ(Summary()["status"], "untrusted");
  EXPECT_EQ(Summary()["stages"].size(), 20U);
  EXPECT_THAT(DifferentFrom(before), IsEmpty());
}

TEST_F(ContinuedPart, AskedForLessWithAnotherOptionNamesWhatItRemoves) {
  const ProgramEnd end = Continue({"--set", "odometry.min_inliers=16", "--until", "odometry"});
  EXPECT_EQ(end.exit_code, 0) << end.err;
  for (const char* name : {"trajectory.tum", "dense.ply", "colmap/models", "evaluation.json"}) {
    EXPECT_THAT(end.err, HasSubstr(name));
    EXPECT_FALSE(fs::exists(out_ / name)) << name;
  }
  EXPECT_EQ(Summary()["status"], "partial");
  EXPECT_EQ(Summary()["reason"], "no gate checked yet");
  EXPECT_THAT(Made(), ElementsAre("odometry"));
  // Going back is free for all that is kept.
  ASSERT_EQ(Continue().exit_code, 0);
  EXPECT_THAT(Made(), ElementsAre("mapping", "fusion", "raster", "las", "views"));
}

TEST_F(ContinuedPart, ByVisualOdometryTakesUpWhatTheRigTechniqueLeft) {
  const ProgramEnd end = Continue({"--technique", "vo"});
  ASSERT_THAT(end.exit_code, testing::AnyOf(0, 3)) << end.err;
  EXPECT_THAT(end.err, HasSubstr("sparse"));  // named, since removed
  const json summary = Summary();
  EXPECT_EQ(summary["technique"], "vo");
  EXPECT_THAT(Made(), Not(testing::Contains(testing::AnyOf("dataset", "features", "odometry"))));
  EXPECT_TRUE(fs::exists(out_ / "dense.ply"));
  EXPECT_FALSE(fs::exists(out_ / "sparse"));
  const json metrics = json::parse(ReadTextFile(out_ / "evaluation.json"));
  EXPECT_EQ(metrics["coverage"], 1.0);
  EXPECT_LT(metrics["ate_se3_pct"].get<double>(), 1.0);
  // And back.
  const ProgramEnd back = Continue();
  ASSERT_EQ(back.exit_code, 0) << back.err;
  EXPECT_THAT(Made(), Not(testing::Contains(testing::AnyOf("features", "matching", "adjustment"))));
  EXPECT_TRUE(fs::exists(out_ / "sparse" / "images.bin"));
}

TEST_F(ContinuedPart, ByIcpTakesUpWhatTheRigTechniqueLeft) {
  const ProgramEnd end = Continue({"--technique", "icp", "--set", "registration.way=improved"});
  ASSERT_THAT(end.exit_code, testing::AnyOf(0, 3)) << end.err;
  const json summary = Summary();
  EXPECT_EQ(summary["technique"], "icp");
  EXPECT_THAT(Made(), Not(testing::Contains(testing::AnyOf("dataset", "features", "odometry"))));
  const json metrics = json::parse(ReadTextFile(out_ / "evaluation.json"));
  EXPECT_EQ(metrics["coverage"], 1.0);
  EXPECT_LT(metrics["ate_se3_pct"].get<double>(), 1.0);
  for (const char* name : {"dense.ply", "view_top.png", "height.tif", "trajectory.csv"}) {
    EXPECT_TRUE(fs::exists(out_ / name)) << name;
  }
}

TEST_F(ContinuedPart, InterruptedSaysHowToGoOn) {
  const fs::path errors = folder_.Path() / "errors";
  const std::string command = "exec " + std::string(RIGMAP_PROGRAM) + " part --dataset '" +
                              data_.string() + "' --out '" + out_.string() +
                              "' --from dataset --quiet 2> '" + errors.string() + "'";
  const pid_t process = fork();
  if (process == 0) {
    execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
    _exit(127);
  }
  for (int waited_ms = 0; fs::exists(out_ / "summary.json") && waited_ms < 60000; ++waited_ms) {
    usleep(1000);
  }
  EXPECT_EQ(EndBySignal(process, SIGINT), SIGINT);
  EXPECT_THAT(ReadTextFile(errors), HasSubstr("the same command again goes on"));
}

// What is kept of single frames is kept for both.
TEST_F(ContinuedPart, GoesBackToEarlierOptionsOfSingleFrames) {
  const auto before = Published();
  for (const char* option : {"dense.uniqueness_pct=12", "features.max_keypoints=900"}) {
    const ProgramEnd there = Continue({"--set", option});
    ASSERT_THAT(there.exit_code, testing::AnyOf(0, 3)) << there.err;
    const ProgramEnd back = Continue();
    ASSERT_EQ(back.exit_code, 0) << back.err;
    EXPECT_THAT(Made(), Not(testing::Contains(testing::AnyOf("features", "dense")))) << option;
    EXPECT_THAT(DifferentFrom(before), IsEmpty()) << option;
  }
  fs::remove_all(out_ / "stages" / "dense");
  ASSERT_EQ(Continue().exit_code, 0);
  EXPECT_THAT(Made(), ElementsAre("dense"));
}

// No state of the process belongs to one part.
TEST_F(ContinuedPart, MadeTwiceAtATimeInOneProcessIsTheSame) {
  const auto request_for = [&](const char* name) {
    PartRequest request;
    request.dataset.folder = data_;
    request.out = folder_.Path() / name;
    request.quiet = true;
    return request;
  };
  PartResult other;
  std::thread thread([&] { other = ReconstructPart(request_for("a")); });
  EXPECT_EQ(ReconstructPart(request_for("b")).status, PartStatus::kOk);
  thread.join();
  EXPECT_EQ(other.status, PartStatus::kOk);
  const auto expected = Published();
  for (const char* name : {"a", "b"}) {
    out_ = folder_.Path() / name;
    EXPECT_THAT(DifferentFrom(expected), IsEmpty()) << name;
    EXPECT_EQ(Summary()["gates"].size(), 23U);
  }
}

}  // namespace
}  // namespace rigmap
