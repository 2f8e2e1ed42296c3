#include "colmap/mapper.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>

#include "colmap/internal/process.h"
#include "colmap/model_io.h"
#include "core/error.h"
#include "core/file.h"
#include "tests/colmap/rover_database.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

using testing::HasSubstr;

constexpr int kFrames = 10;
constexpr int kSeedFrames = 4;

double Median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

// A part on disk: its database, and folders to work in.
class MapperTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    rover_ = MakeSyntheticRover({.frames = kFrames, .seed = 11});
    content_ = RoverDatabase(rover_, 2);
  }

  void SetUp() override { WriteDatabase(colmap_, content_, At("database.db"), At("log")); }

  std::filesystem::path At(const std::string& name) const { return folder_.Path() / name; }

  SparseModel Triangulate(const SparseModel& poses) {
    WriteModel(poses, At("poses"));
    RunPointTriangulator(colmap_, {},
                         {.database = At("database.db"),
                          .images = At("images"),
                          .input_model = At("poses"),
                          .output = At("triangulated"),
                          .log = At("log")});
    return ReadModel(At("triangulated"));
  }

  MapperRequest Request() const {
    return {.database = At("database.db"),
            .images = At("images"),
            .seed = std::nullopt,
            .output = At("models"),
            .log = At("log"),
            .threads = 2,
            .on_progress = {}};
  }

  // The point of the rover that a keypoint of a left image shows.
  static const Eigen::Vector3d* TruePoint(const TrackElement& element) {
    if (element.image.eye == Eye::kRight) return nullptr;
    const auto& point_of_feature = rover_.point_of_feature[element.image.frame];
    return &rover_.points[point_of_feature[element.keypoint]];
  }

  static std::vector<double> LeftRightDistances(const SparseModel& model) {
    std::map<ImageRef, Eigen::Vector3d> centres;
    for (const auto& image : model.images) {
      centres[image.ref] = image.camera_from_model.Inverse().translation;
    }
    std::vector<double> distances;
    for (const auto& [ref, centre] : centres) {
      const auto right = centres.find({ref.frame, Eye::kRight});
      if (ref.eye == Eye::kLeft && right != centres.end()) {
        distances.push_back((right->second - centre).norm());
      }
    }
    return distances;
  }

  static void ExpectEqualBaselines(const SparseModel& model, double tolerance) {
    const auto distances = LeftRightDistances(model);
    ASSERT_EQ(distances.size(), static_cast<std::size_t>(kFrames));
    const double median = Median(distances);
    for (const double distance : distances) EXPECT_NEAR(distance / median, 1.0, tolerance);
  }

  static SyntheticRover rover_;
  static DatabaseContent content_;
  ColmapInstallation colmap_ = FindColmap();
  TemporaryFolder folder_;
};

SyntheticRover MapperTest::rover_;
DatabaseContent MapperTest::content_;

TEST_F(MapperTest, TriangulatesTruePosesToTruePoints) {
  const SparseModel poses = RoverPoses(rover_, kFrames);
  const SparseModel model = Triangulate(poses);
  ASSERT_EQ(model.images.size(), 2u * kFrames);
  std::map<ImageRef, Rigid3> true_pose;
  for (const auto& image : poses.images) true_pose[image.ref] = image.camera_from_model;
  for (const auto& image : model.images) {
    EXPECT_NEAR((image.camera_from_model.translation - true_pose[image.ref].translation).norm(),
                0.0,
                1e-9);  // m
  }
  std::vector<double> errors_m;
  for (const auto& point : model.points) {
    for (const auto& element : point.track) {
      if (const auto* true_point = TruePoint(element)) {
        errors_m.push_back((point.x_in_model - *true_point).norm());
      }
    }
  }
  EXPECT_GT(model.points.size(), 500u);
  EXPECT_LT(Median(errors_m), 0.01);  // m; 0.2 px at 3 m make 0.02 m for a single pair
}

TEST_F(MapperTest, TriangulatesInTheGaugeOfThePoses) {
  SparseModel twice = RoverPoses(rover_, kFrames);
  for (auto& image : twice.images) image.camera_from_model.translation *= 2.0;
  std::vector<double> ratios;
  for (const auto& point : Triangulate(twice).points) {
    for (const auto& element : point.track) {
      if (const auto* x = TruePoint(element)) ratios.push_back(point.x_in_model.norm() / x->norm());
    }
  }
  EXPECT_NEAR(Median(ratios), 2.0, 0.01);
}

TEST_F(MapperTest, ContinuesAMetricSeedToAllImages) {
  Triangulate(RoverPoses(rover_, kSeedFrames));
  MapperRequest request = Request();
  request.seed = At("triangulated");
  int registered = 0;
  request.on_progress = [&](int count) {
    EXPECT_GE(count, registered);
    registered = count;
  };
  const auto models = RunMapper(colmap_, {}, request);
  ASSERT_EQ(models, std::vector<std::filesystem::path>{At("models") / "0"});
  EXPECT_EQ(registered, 2 * kFrames);
  const SparseModel model = ReadModel(models[0]);
  EXPECT_EQ(model.images.size(), 2u * kFrames);
  EXPECT_EQ(model.cameras[0].camera.fx, rover_.rig.Of(model.cameras[0].eye).camera.fx);
  ExpectEqualBaselines(model, 0.005);
  for (const auto& image : model.images) {  // ours and COLMAP's keypoints are the same
    const auto& keypoints =
        content_.images[2 * image.ref.frame + (image.ref.eye == Eye::kLeft ? 0 : 1)].keypoints;
    ASSERT_EQ(image.keypoints.size(), keypoints.size());
    EXPECT_EQ(image.keypoints[7].pixel.cast<float>(), keypoints[7]);
  }
}

TEST_F(MapperTest, ThreadsDoNotChangeTheModel) {
  Triangulate(RoverPoses(rover_, kSeedFrames));
  MapperRequest request = Request();
  request.seed = At("triangulated");
  const auto run = [&](int threads) {
    std::string bytes;
    request.threads = threads;
    const auto folder = RunMapper(colmap_, {}, request).at(0);
    for (const char* file : {"cameras.bin", "images.bin", "points3D.bin"}) {
      bytes += ReadTextFile(folder / file);
    }
    return bytes;
  };
  const std::string bytes = run(2);
  EXPECT_EQ(bytes, run(2));
  EXPECT_EQ(bytes, run(1));
}

TEST_F(MapperTest, MapsWithoutASeedIntoNumberedFolders) {
  // Lean, for speed; where the models stand is all that is asked.
  const auto models = RunMapper(colmap_, {}, Request());
  ASSERT_FALSE(models.empty());
  EXPECT_EQ(models[0], At("models") / "0");
  EXPECT_GT(ReadModel(models[0]).images.size(), static_cast<std::size_t>(kFrames));
}

TEST_F(MapperTest, LeavesNothingInTheTemporaryFolder) {
  const TemporaryFolder elsewhere;
  const char* before = getenv("TMPDIR");
  const std::string kept = before == nullptr ? "" : before;
  setenv("TMPDIR", elsewhere.Path().c_str(), 1);
  Triangulate(RoverPoses(rover_, kSeedFrames));
  RunMapper(colmap_, {}, Request());
  before == nullptr ? unsetenv("TMPDIR") : setenv("TMPDIR", kept.c_str(), 1);
  EXPECT_TRUE(std::filesystem::is_empty(elsewhere.Path()));
}

// "--Mapper.NAME VALUE" and "--Mapper.NAME arg (=VALUE)" alike.
std::map<std::string, double> MapperValues(const std::string& text) {
  static const std::regex kOption("--Mapper\\.(\\w+) (?:arg \\(=)?([-+.0-9e]+)");
  std::map<std::string, double> values;
  for (std::sregex_iterator it(text.begin(), text.end(), kOption), end; it != end; ++it) {
    values[(*it)[1]] = std::stod((*it)[2]);
  }
  return values;
}

TEST_F(MapperTest, StockOptionsAreColmapsOwnButForTheCalibration) {
  std::string help;
  ProcessRequest process{.program = colmap_.path, .arguments = {"mapper", "--help"}};
  process.on_line = [&](const std::string& line) { help += line + "\n"; };
  RunProcess(process);
  auto own = MapperValues(help);
  own["ba_refine_focal_length"] = 0;
  own["ba_refine_extra_params"] = 0;
  own["extract_colors"] = 0;
  own["num_threads"] = 2;
  own["ba_min_num_residuals_for_multi_threading"] = 2147483647;

  MapperRequest request = Request();
  request.log = At("command");
  EXPECT_THROW(RunMapper({"true", "3.8"}, StockMapperOptions(), request), ToolError);
  const auto ours = MapperValues(ReadTextFile(request.log));
  EXPECT_GT(ours.size(), 20u);
  for (const auto& [name, value] : ours) {
    ASSERT_TRUE(own.count(name)) << name;
    EXPECT_NEAR(value, own[name], 1e-12) << name;
  }
}

TEST_F(MapperTest, NoModelIsAnErrorWithTheLastLines) {
  DatabaseContent content = content_;
  for (auto& pair : content.pairs) pair.matches.clear();
  WriteDatabase(colmap_, content, At("database.db"), At("log"));
  try {
    RunMapper(colmap_, StockMapperOptions(), Request());
    FAIL() << "expected a ToolError";
  } catch (const ToolError& error) {
    EXPECT_THAT(error.what(), HasSubstr("incremental mapping"));
    EXPECT_THAT(error.what(), HasSubstr(At("log").string()));
    EXPECT_THAT(error.what(), HasSubstr("last lines"));
  }
}

TEST_F(MapperTest, ExitCodeZeroWithoutAModelIsAnError) {
  const auto program = At("colmap");
  std::ofstream(program) << "#!/bin/sh\necho 'SQLite error: database is locked'\n";
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  try {
    RunMapper({program.string(), "3.8"}, {}, Request());
    FAIL() << "expected a ToolError";
  } catch (const ToolError& error) {
    EXPECT_THAT(error.what(), HasSubstr("found none (its last lines: SQLite error: database is"));
  }
}

}  // namespace
}  // namespace rigmap
