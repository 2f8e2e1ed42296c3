// The metrics of maps and rocks against scorers that were written apart from this project.
#include <algorithm>
#include <cmath>

#include "evaluation/map_metrics.h"
#include "evaluation/rock_metrics.h"
#include "tests/evaluation/ply_text.h"
#include "tests/evaluation/reference_scorer.h"
#include "tests/support/seeded_random.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_file.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

using Points = std::vector<Eigen::Vector3f>;

// One unit of the last digit that is printed under `key`.
double LastDigit(const std::string& key) {
  const auto ends_with = [&](const char* end) { return key.ends_with(end); };
  if (key.starts_with("accuracy_") || key == "x" || key == "y") return 1e-2;
  if (key.starts_with("ghost_") || key == "distance_m") return 1e-2;
  if (key.starts_with("doubled_")) return 1e-1;
  if (ends_with("_mm")) return 1e-1;
  if (key.starts_with("stray_") || key.find("stretch") != std::string::npos) return 1e-3;
  if (key == "complete_2cm") return 1e-3;
  if (ends_with("cm")) return 1e-4;
  return 0.0;  // counts
}

// `key` is that of the innermost object around the value.
void ExpectEqual(const ordered_json& found, const ordered_json& expected, const std::string& key) {
  ASSERT_EQ(found.size(), expected.size()) << key << "\n" << found << "\n" << expected;
  if (expected.is_object()) {
    auto it = found.begin();
    for (const auto& [name, value] : expected.items()) {
      ASSERT_EQ(it.key(), name) << found << "\n" << expected;
      ExpectEqual(*it++, value, name);
    }
  } else if (expected.is_array()) {
    for (std::size_t i = 0; i < expected.size(); ++i) ExpectEqual(found[i], expected[i], key);
  } else if (expected.is_number()) {
    ASSERT_TRUE(found.is_number()) << key << ": " << found << ", expected " << expected;
    EXPECT_LE(std::abs(found.get<double>() - expected.get<double>()), 1.001 * LastDigit(key))
        << key << ": " << found << ", expected " << expected;
  } else {
    EXPECT_EQ(found, expected) << key;
  }
}

class MapReferenceScorer : public ReferenceScorerTest {
 protected:
  void UseTruth(const char* part) {
    folder_ = data_ / "beach-dev" / "truth" / part;
    truth_ = ReadMapTruth({folder_}, ReadTum(folder_ / "trajectory.tum"));
    ASSERT_TRUE(truth_) << folder_;
  }

  // Every `step`-th visible point, 4 mm off in any direction and with a millimetre of bias.
  Points NoisySubsample(std::size_t step) {
    Points points;
    const TrueSurface& surface = truth_->surface;
    for (std::size_t i = 0; i < surface.size(); ++i) {
      if (!surface.visible[i] || i % step != 0) continue;
      const Eigen::Vector3d noise = random_.Noise(0.004) + Eigen::Vector3d(0.0, 0.0, 0.001);
      points.push_back(surface.x_in_truth[i] + noise.cast<float>());
    }
    return points;
  }

  // Points anywhere around the path, up to a metre and a half above the sand.
  Points Strays(std::size_t count) {
    Points points;
    for (std::size_t i = 0; i < count; ++i) {
      const auto& pose = truth_->path[i % truth_->path.size()].world_from_body;
      points.push_back((pose.translation + random_.Vector(1.5)).cast<float>());
    }
    return points;
  }

  // Every sixth point of the rocks once more, 8 cm higher and 5 cm aside, as a bad loop leaves it.
  Points SecondRocks() {
    Points points;
    const TrueSurface& surface = truth_->surface;
    for (std::size_t i = 0; i < surface.size(); i += 6) {
      if (surface.kind[i] != kRockKind || !surface.visible[i]) continue;
      points.push_back(surface.x_in_truth[i] + Eigen::Vector3f(0.05F, 0.0F, 0.08F));
    }
    return points;
  }

  // The visible surface with a millimetre of noise, every tenth point of the sand and every second
  // of the rocks, or what `spoil` makes of it: from the point and its position from the rock's
  // centre.
  template <class Spoil>
  Points WithRocksSpoilt(const Spoil& spoil) {
    Points points;
    const TrueSurface& surface = truth_->surface;
    for (std::size_t i = 0; i < surface.size(); ++i) {
      if (!surface.visible[i] || i % (surface.kind[i] == kRockKind ? 2 : 10) != 0) continue;
      const Eigen::Vector3d x = surface.x_in_truth[i].cast<double>() + random_.Noise(0.001);
      if (surface.kind[i] != kRockKind) {
        points.push_back(x.cast<float>());
        continue;
      }
      const auto distance = [&](const TrueRock& rock) { return (rock.x_in_truth - x).norm(); };
      const auto rock = std::ranges::min_element(truth_->rocks, {}, distance);
      for (const auto& spoilt : spoil(x, Eigen::Vector3d(x - rock->x_in_truth))) {
        points.push_back(spoilt.template cast<float>());
      }
    }
    return points;
  }

  // Poses a little off, some lost, stamps late or early.
  Trajectory Estimate(const Rigid3& world_from_truth) {
    Trajectory estimate;
    for (const TumPose& pose : truth_->path) {
      if (random_.Uniform(0.0, 1.0) < 0.1) continue;
      TimedPose noisy;
      noisy.stamp_ns = pose.stamp_ns + static_cast<StampNs>(random_.Uniform(-2.2e7, 2.2e7));
      noisy.world_from_left = world_from_truth * pose.world_from_body *
                              Rigid3{random_.Rotation(0.004), random_.Noise(0.005)};
      estimate.push_back(noisy);
    }
    return estimate;
  }

  ordered_json Reference(const char* scorer, const fs::path& map, const fs::path& trajectory) {
    return ordered_json::parse(
        OutputOf(fmt::format("{} '{}' '{}' '{}' '{}' --json", kPython, Scorer(scorer).string(),
                             map.string(), trajectory.string(), folder_.string())));
  }

  // The map and the trajectory go to a world of their own first.
  ordered_json Compare(Points map_in_truth, bool rocks_alone = false) {
    const Rigid3 world_from_truth = random_.Motion(5.0);
    for (auto& x : map_in_truth) x = (world_from_truth * x.cast<double>()).cast<float>();
    const TemporaryFolder files;
    const auto map = WriteTestFile(files.Path() / "map.ply", MapPly(map_in_truth));
    const auto trajectory =
        WriteTestFile(files.Path() / "trajectory.tum", WriteTum(Estimate(world_from_truth)));
    const auto truth_from_world = AlignWithTruth(ReadTum(trajectory), truth_->path);
    const MapOverTruth over(ReadMapPoints(map), truth_from_world.value(), *truth_);
    const ordered_json rocks = ToJson(CompareRocks(over));
    ExpectEqual(rocks, Reference("rock_fit.py", map, trajectory), "rocks");
    if (rocks_alone) return rocks;
    ExpectEqual(ToJson(CompareMap(over)), Reference("map_metrics.py", map, trajectory), "map");
    return rocks;
  }

  SeededRandom random_;
  fs::path folder_;
  std::optional<MapTruth> truth_;
};

Points Union(Points points, const Points& more) {
  points.insert(points.end(), more.begin(), more.end());
  return points;
}

TEST_F(MapReferenceScorer, AgreesOnANoisyMapWithStraysAndSecondRocks) {
  UseTruth("Part1");
  const auto rocks = Compare(Union(Union(NoisySubsample(12), Strays(2000)), SecondRocks()));
  EXPECT_GT(rocks["rocks"], 2);
  EXPECT_GT(rocks["ghost_max_pct"], 10.0);
}

TEST_F(MapReferenceScorer, AgreesOnPlantedErrorsOfRocks) {
  UseTruth("Part1");
  using Positions = std::vector<Eigen::Vector3d>;
  const auto worst = [&](const char* key, const auto& spoil) {
    const auto rocks = Compare(WithRocksSpoilt(spoil), true);
    EXPECT_EQ(rocks["rocks"], 4);
    return rocks[key].template get<double>();
  };
  const auto plain = [](const auto& x, const auto&) { return Positions{x}; };
  EXPECT_LT(worst("shift_max_mm", plain), 10.0);  // the poses are a little off
  const auto shifted = [](const auto& x, const auto&) {
    return Positions{x + Eigen::Vector3d(0.02, 0.0, 0.0)};
  };
  EXPECT_GT(worst("shift_max_mm", shifted), 10.0);
  const auto stretched = [](const auto& x, const auto& arm) {
    return Positions{x + 0.08 * Eigen::Vector3d(0.0, arm.y(), 0.0)};
  };
  EXPECT_GT(worst("stretch_max_off", stretched), 0.05);
  const auto topless = [](const auto& x, const auto& arm) {
    return arm.z() > 0.2 ? Positions{} : Positions{x};
  };
  EXPECT_GT(worst("top_max_mm", topless), 20.0);
  const auto twice = [](const auto& x, const auto&) {
    return Positions{x, x + Eigen::Vector3d(0.018, 0.018, 0.0)};
  };
  EXPECT_GT(worst("doubled_max_pct", twice), 10.0);
}

TEST_F(MapReferenceScorer, AgreesOnAPartWithoutRocksNearby) {
  UseTruth("Part2");
  EXPECT_EQ(Compare(NoisySubsample(12))["rocks"], 0);
}

// Nothing near the path; a rock or two only half there.
TEST_F(MapReferenceScorer, AgreesWhereMuchIsMissing) {
  UseTruth("Part1");
  Points half;
  for (const auto& x : NoisySubsample(10)) {
    const auto far = [&](const TumPose& pose) {
      return (pose.world_from_body.translation.head<2>() - x.cast<double>().head<2>()).norm() > 1.7;
    };
    if (std::all_of(truth_->path.begin(), truth_->path.end(), far)) half.push_back(x);
  }
  const auto rocks = Compare(half);
  EXPECT_LT(rocks["found"], rocks["rocks"]);
}

TEST_F(MapReferenceScorer, AgreesOnAnEmptyMap) {
  UseTruth("Part1");
  EXPECT_EQ(Compare({})["found"], 0);
}

}  // namespace
}  // namespace rigmap
