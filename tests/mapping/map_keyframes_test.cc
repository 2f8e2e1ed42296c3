#include "mapping/map_keyframes.h"

#include <gmock/gmock.h>

#include <fstream>
#include <numbers>
#include <set>

#include "colmap/model_io.h"
#include "core/error.h"
#include "geometry/alignment.h"
#include "scale/baseline_scale.h"
#include "tests/mapping/rover_part.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kDegree = std::numbers::pi / 180.0;

std::set<int> Keyframes(const SparseModel& model) {
  std::set<int> keyframes;
  for (const SparseImage& image : model.images) {
    keyframes.insert(image.ref.frame);
  }
  return keyframes;
}

// Largest distance between two paths once the first is laid on the second, scale held at 1.
double PathError_m(const std::vector<Rigid3>& found, const std::vector<Rigid3>& truth) {
  std::vector<Eigen::Vector3d> from, to;
  for (const Rigid3& pose : found) from.push_back(pose.translation);
  for (const Rigid3& pose : truth) to.push_back(pose.translation);
  const Sim3 truth_from_found = AlignPoints(from, to, false);
  double largest = 0.0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    largest = std::max(largest, (truth_from_found * from[i] - to[i]).norm());
  }
  return largest;
}

class MapKeyframesTest : public testing::Test {
 protected:
  // A part whose odometry errs by 3 mm and 0.05 degrees a step.
  void Make(const SyntheticRoverOptions& options) {
    part_ = MakeRoverPart(options);
    poses_ = DriftingPoses(part_.rover, 0.003, 0.05 * kDegree, random_);
    part_.odometry = OdometryOfKeyframes(part_.rover, poses_);
  }

  MappingResult Map(const MappingOptions& options, const KeyframeGraphOptions& graph = {}) {
    graph_ = part_.Graph(graph);
    WriteDatabase(colmap_, MakeDatabaseContent(graph_, part_.correspondences, part_.rover.rig),
                  At("database.db"), At("log"));
    return MapKeyframes(colmap_, {graph_, part_.correspondences, part_.rover.rig, poses_}, Paths(),
                        options, 2);
  }

  MappingPaths Paths() const {
    return {.database = At("database.db"),
            .images = At("images"),
            .models = At("models"),
            .scratch = At("scratch"),
            .log = At("log")};
  }

  std::filesystem::path At(const std::string& name) const { return folder_.Path() / name; }

  BaselineScale ScaleOf(const SparseModel& model) const {
    return MeasureBaseline(model, part_.rover.rig.Baseline(), {}).value();
  }

  // Of all keyframes, placed by scale and odometry; each must have a pose.
  std::vector<Rigid3> Align(const MappingResult& result) const {
    std::vector<Rigid3> aligned;
    for (const auto& pose :
         AlignModels(result.models, MeasureBaselines(result.models, part_.rover.rig.Baseline(), {}),
                     poses_)
             .world_from_left) {
      aligned.push_back(pose.value());
    }
    return aligned;
  }

  void ExpectFoldersLike(const MappingResult& result) const {
    for (std::size_t i = 0; i < result.models.size(); ++i) {
      const SparseModel stored = ReadModel(At("models") / std::to_string(i));
      ASSERT_EQ(stored.images.size(), result.models[i].images.size());
      EXPECT_EQ(stored.images[0].name, result.models[i].images[0].name);
      EXPECT_EQ(stored.points.size(), result.models[i].points.size());
    }
    const auto folders = std::filesystem::directory_iterator(At("models"));
    EXPECT_EQ(static_cast<std::size_t>(std::distance(begin(folders), end(folders))),
              result.models.size());
  }

  RoverPart part_;
  KeyframeGraph graph_;
  std::vector<Rigid3> poses_;
  SeededRandom random_;
  ColmapInstallation colmap_ = FindColmap();
  TemporaryFolder folder_;
};

// Relief of 0.15 m, and flat ground: where mapping that is not seeded comes out wrong.
class SeededOnGround : public MapKeyframesTest, public testing::WithParamInterface<double> {};

TEST_P(SeededOnGround, RegistersAllAndKeepsTheEyesApartAlike) {
  Make({.frames = 12, .relief_m = GetParam(), .seed = 21});
  const MappingResult result = Map({});
  EXPECT_EQ(result.method, MappingMethod::kSeeded);
  EXPECT_THAT(result.remarks, IsEmpty());
  ASSERT_EQ(result.models.size(), 1u);
  EXPECT_EQ(result.models[0].images.size(), 24u);
  ExpectFoldersLike(result);
  const BaselineScale scale = ScaleOf(result.models[0]);
  EXPECT_LT(scale.relative_spread, 0.01);
  EXPECT_THAT(scale.pairs_rejected, IsEmpty());
  EXPECT_LT(PathError_m(Align(result), part_.rover.world_from_left), 0.005);  // of 2.2 m
  EXPECT_GT(PathError_m(poses_, part_.rover.world_from_left), 0.006);         // the odometry alone
}

INSTANTIATE_TEST_SUITE_P(Ground, SeededOnGround, testing::Values(0.15, 0.0),
                         [](const auto& ground) { return ground.param > 0.0 ? "Relief" : "Flat"; });

TEST_F(MapKeyframesTest, TriangulatesOnTheOdometricPoses) {
  Make({.frames = 10, .seed = 22});
  const MappingResult result =
      Map({.method = MappingMethod::kTriangulate}, {.tracks_per_keyframe = 300});
  EXPECT_EQ(result.method, MappingMethod::kTriangulate);
  ASSERT_EQ(result.models.size(), 1u);
  ExpectFoldersLike(result);
  EXPECT_EQ(Keyframes(result.models[0]).size(), 10u);
  EXPECT_GE(result.models[0].points.size(), 250u);
  EXPECT_LT(ScaleOf(result.models[0]).relative_spread, 1e-9);  // by construction
  EXPECT_NEAR(ScaleOf(result.models[0]).metres_per_model_unit, 1.0, 1e-9);
  const auto aligned = Align(result);
  for (std::size_t k = 0; k < aligned.size(); ++k) {
    EXPECT_LT((aligned[k].translation - poses_[k].translation).norm(), 1e-9);  // m
  }
}

TEST_F(MapKeyframesTest, UnseededRunsWithStockOptions) {
  Make({.frames = 7, .step_m = 0.4, .relief_m = 0.3, .seed = 23});
  const MappingResult result =
      Map({.method = MappingMethod::kUnseeded}, {.tracks_per_keyframe = 100});
  EXPECT_EQ(result.method, MappingMethod::kUnseeded);
  ASSERT_FALSE(result.models.empty());
  ExpectFoldersLike(result);
  for (std::size_t i = 1; i < result.models.size(); ++i) {
    EXPECT_LE(result.models[i].images.size(), result.models[i - 1].images.size());
  }
  EXPECT_GE(result.models[0].images.size(), 10u);  // COLMAP drops smaller ones
}

TEST_F(MapKeyframesTest, ACutPartIsSeededAnewAndJoinedByOdometry) {
  Make({.frames = 14, .seed = 24});
  CutBefore(5, part_.correspondences);
  const MappingResult result = Map({});
  EXPECT_EQ(result.method, MappingMethod::kSeeded);
  ASSERT_EQ(result.models.size(), 2u);
  EXPECT_EQ(Keyframes(result.models[0]), (std::set<int>{5, 6, 7, 8, 9, 10, 11, 12, 13}));
  EXPECT_EQ(Keyframes(result.models[1]), (std::set<int>{0, 1, 2, 3, 4}));
  ExpectFoldersLike(result);
  // Of 2.6 m; one step of odometry (3 mm and 0.05 degrees an axis) and three models' noise.
  EXPECT_LT(PathError_m(Align(result), part_.rover.world_from_left), 0.015);
}

TEST_F(MapKeyframesTest, WhatIsLeftShorterThanAModelIsNotSeeded) {
  Make({.frames = 10, .seed = 25});
  CutBefore(3, part_.correspondences);
  const MappingResult result = Map({});
  ASSERT_EQ(result.models.size(), 1u);
  EXPECT_EQ(Keyframes(result.models[0]), (std::set<int>{3, 4, 5, 6, 7, 8, 9}));
}

TEST_F(MapKeyframesTest, NoMoreModelsThanAllowed) {
  Make({.frames = 10, .seed = 26});
  CutBefore(5, part_.correspondences);
  EXPECT_EQ(Map({.max_models = 1}).models.size(), 1u);
}

TEST_F(MapKeyframesTest, WithoutASeedTheOdometricPosesAreTriangulated) {
  Make({.frames = 10, .seed = 27});
  // Twenty matches at every link: too few to start from, enough to triangulate.
  for (FramePair& pair : part_.correspondences.pairs) {
    pair.matches.resize(pair.b == pair.a + 1 ? 20 : 0);
  }
  const MappingResult result = Map({});
  EXPECT_EQ(result.method, MappingMethod::kTriangulate);
  ASSERT_EQ(result.remarks.size(), 1u);
  EXPECT_THAT(result.remarks[0], HasSubstr("the odometric poses were triangulated"));
  ASSERT_EQ(result.models.size(), 1u);
  EXPECT_EQ(Keyframes(result.models[0]).size(), 10u);
  EXPECT_FALSE(result.models[0].points.empty());
}

TEST_F(MapKeyframesTest, WhenColmapMakesNoModelTheOdometricPosesAreTriangulated) {
  Make({.frames = 8, .seed = 28});
  // A COLMAP whose mapper gives up and whose triangulator works.
  std::ofstream(At("colmap")) << "#!/bin/sh\n[ \"$1\" = mapper ] && exit 1\nexec '" << colmap_.path
                              << "' \"$@\"\n";
  std::filesystem::permissions(At("colmap"), std::filesystem::perms::owner_all);
  colmap_.path = At("colmap").string();
  for (const auto method : {MappingMethod::kSeeded, MappingMethod::kUnseeded}) {
    const MappingResult result = Map({.method = method}, {.tracks_per_keyframe = 300});
    EXPECT_EQ(result.method, MappingMethod::kTriangulate);
    ASSERT_GE(result.remarks.size(), 2u);
    EXPECT_THAT(result.remarks.front(), HasSubstr("led to no model: incremental mapping"));
    EXPECT_THAT(result.remarks.back(), HasSubstr("the odometric poses were triangulated"));
    ASSERT_EQ(result.models.size(), 1u);
    EXPECT_EQ(Keyframes(result.models[0]).size(), 8u);
    EXPECT_GT(result.models[0].points.size(), 200u);
    ExpectFoldersLike(result);
  }
}

TEST_F(MapKeyframesTest, AColmapThatCannotRunIsAnError) {
  Make({.frames = 6, .points_per_m2 = 8.0, .seed = 29});
  Map({.method = MappingMethod::kTriangulate});
  for (const auto method :
       {MappingMethod::kSeeded, MappingMethod::kTriangulate, MappingMethod::kUnseeded}) {
    EXPECT_THROW(
        MapKeyframes({"false", "3.8"}, {graph_, part_.correspondences, part_.rover.rig, poses_},
                     Paths(), {.method = method}, 1),
        ToolError)
        << NameOf(method);
  }
}

TEST_F(MapKeyframesTest, EqualInputGivesEqualModels) {
  Make({.frames = 8, .points_per_m2 = 10.0, .seed = 30});
  const MappingResult once = Map({}), again = Map({});
  ASSERT_EQ(once.models.size(), again.models.size());
  for (std::size_t i = 0; i < once.models[0].images.size(); ++i) {
    EXPECT_EQ(once.models[0].images[i].camera_from_model.translation,
              again.models[0].images[i].camera_from_model.translation);
  }
  EXPECT_EQ(once.models[0].points.size(), again.models[0].points.size());
}

}  // namespace
}  // namespace rigmap
