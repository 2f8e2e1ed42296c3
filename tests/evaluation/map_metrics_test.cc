#include "evaluation/map_metrics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/evaluation/synthetic_beach.h"
#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

std::vector<TumPose> Moved(const Sim3& world_from_truth, std::vector<TumPose> poses) {
  for (TumPose& pose : poses) {
    pose.world_from_body = TransformPose(world_from_truth, pose.world_from_body);
  }
  return poses;
}

Points Moved(const Sim3& world_from_truth, Points points) {
  for (auto& x : points) x = (world_from_truth * x.cast<double>()).cast<float>();
  return points;
}

// A map and a trajectory in a world of their own, laid over the truth by their poses.
MapMetrics CompareMoved(const Sim3& world_from_truth, const Points& map, const MapTruth& truth) {
  const auto truth_from_world = AlignWithTruth(Moved(world_from_truth, truth.path), truth.path);
  return CompareMap(MapOverTruth(Moved(world_from_truth, map), truth_from_world.value(), truth));
}

TEST(CompareMap, FindsNoErrorInTheTruth) {
  const MapTruth truth = MakeBeach({});
  const MapMetrics metrics = CompareMap(AlreadyAligned(PerfectMap(truth), truth));
  EXPECT_EQ(metrics.map_points, truth.surface.size());
  EXPECT_EQ(metrics.visible_points, metrics.truth_points);
  EXPECT_EQ(metrics.judged, 3U);
  for (std::size_t b = 0; b < metrics.judged; ++b) {
    const auto& band = metrics.bands[b];
    ASSERT_TRUE(band);
    EXPECT_EQ(band->accuracy_p90_m, 0.0);
    EXPECT_EQ(band->stray_share, 0.0);
    for (const MapShares& shares : band->at_tolerance) EXPECT_EQ(shares.HarmonicMean(), 1.0);
  }
}

TEST(CompareMap, FindsAMapFiveMillimetresTooHigh) {
  const MapTruth truth = MakeBeach({});
  const Points map = Displaced(PerfectMap(truth), {0.0F, 0.0F, 0.005F});
  const auto json = ToJson(CompareMap(AlreadyAligned(map, truth)));
  for (const char* band : {"within_1.5m", "within_2.5m", "within_3.5m"}) {
    EXPECT_EQ(json[band]["accuracy_median_mm"], 5.0);
    EXPECT_EQ(json[band]["accuracy_p90_mm"], 5.0);
    EXPECT_EQ(json[band]["completeness_1cm"], 1.0);
  }
}

// 15 mm up, half a grid's step aside: the plane is 15 mm away, the nearest points are farther.
TEST(CompareMap, TakesTheDistanceFromThePlaneNearby) {
  const MapTruth truth = MakeBeach({});
  const Points map = Displaced(PerfectMap(truth), {0.005F, 0.0F, 0.015F});
  const MapMetrics metrics = CompareMap(AlreadyAligned(map, truth));
  EXPECT_NEAR(metrics.bands[0]->accuracy_median_m, 0.015, 1e-6);
  EXPECT_EQ(metrics.bands[0]->at_tolerance[0].completeness, 0.0);
  EXPECT_EQ(metrics.bands[0]->at_tolerance[1].completeness, 1.0);
  EXPECT_EQ(metrics.bands[0]->at_tolerance[0].precision, 0.0);
  EXPECT_EQ(metrics.bands[0]->at_tolerance[1].precision, 1.0);
}

// 5 mm up: within two sigmas for the half that states 3 mm, within none for that of 1 mm.
TEST(CompareMap, AsksHowManySigmasOffPointsAre) {
  const MapTruth truth = MakeBeach({});
  const Points map = Displaced(PerfectMap(truth), {0.0F, 0.0F, 0.005F});
  std::vector<float> sigmas_m(map.size(), 0.003F);
  std::size_t near = 0, sure = 0;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (i % 2 == 0) sigmas_m[i] = 0.001F;
  }
  const MapOverTruth over(map, Rigid3{}, truth, sigmas_m);
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (!over.FromPath(over.MapPoint(i), 1.5)) continue;
    ++near;
    if (i % 2 == 1) ++sure;
  }
  const auto json = SigmasToJson(CompareMap(over));
  EXPECT_EQ(json["within_1.5m"]["within_1_sigma_pct"], 0.0);
  EXPECT_NEAR(json["within_1.5m"]["within_2_sigma_pct"],
              100.0 * static_cast<double>(sure) / static_cast<double>(near), 0.01);
  EXPECT_NEAR(json["within_1.5m"]["within_3_sigma_pct"], 50.0, 1.0);
  EXPECT_TRUE(SigmasToJson(CompareMap(AlreadyAligned(map, truth))).is_null());
}

TEST(CompareMap, TakesAMetreForWhatIsFartherThanThat) {
  const MapTruth truth = MakeBeach({});
  const Points map = Displaced(PerfectMap(truth), {0.0F, 0.0F, 7.0F});
  const MapMetrics metrics = CompareMap(AlreadyAligned(map, truth));
  EXPECT_EQ(metrics.bands[2]->accuracy_median_m, 1.0);
  EXPECT_EQ(metrics.bands[2]->stray_share, 1.0);
  EXPECT_EQ(metrics.bands[2]->at_tolerance[2].HarmonicMean(), 0.0);
}

TEST(CompareMap, CountsStrays) {
  const MapTruth truth = MakeBeach({});
  Points map(60, {1.0F, 0.2F, 0.0F});
  map.resize(80, {1.0F, 2.0F, 0.3F});
  const MapMetrics metrics = CompareMap(AlreadyAligned(map, truth));
  EXPECT_EQ(metrics.bands[0]->points, 60U);
  EXPECT_EQ(metrics.bands[0]->stray_share, 0.0);
  EXPECT_EQ(metrics.bands[1]->points, 80U);
  EXPECT_EQ(metrics.bands[1]->stray_share, 0.25);
  EXPECT_NEAR(metrics.bands[1]->accuracy_p90_m, 0.3, 1e-6);
  EXPECT_EQ(metrics.bands[1]->accuracy_median_m, 0.0);
}

TEST(CompareMap, CountsWhatIsMissing) {
  const MapTruth truth = MakeBeach({});
  Points left;
  for (const auto& x : truth.surface.x_in_truth) {
    if (x.y() > 0.0F) left.push_back(x);
  }
  const MapMetrics metrics = CompareMap(AlreadyAligned(left, truth));
  for (std::size_t b = 0; b < metrics.judged; ++b) {
    const auto& band = metrics.bands[b];
    EXPECT_EQ(band->at_tolerance[0].precision, 1.0);
    EXPECT_NEAR(band->at_tolerance[0].completeness, 0.5, 0.01);
  }
}

TEST(CompareMap, AsksForWhatTheCamerasSawOnly) {
  MapTruth truth = MakeBeach({});
  Points left;
  for (std::size_t i = 0; i < truth.surface.size(); ++i) {
    truth.surface.visible[i] = truth.surface.x_in_truth[i].y() > 0.0F;
    if (truth.surface.visible[i]) left.push_back(truth.surface.x_in_truth[i]);
  }
  const MapMetrics metrics = CompareMap(AlreadyAligned(left, truth));
  EXPECT_EQ(metrics.visible_points, left.size());
  EXPECT_EQ(metrics.bands[2]->at_tolerance[0].completeness, 1.0);
}

// The beach is 4 m wide to either side.
TEST(CompareMap, JudgesNothingWhereTheTrueSurfaceEnds) {
  MapTruth truth = MakeBeach({});
  Points map = PerfectMap(truth);
  map.push_back({1.0F, 5.0F, 0.0F});
  const MapMetrics narrow = CompareMap(AlreadyAligned(map, truth));
  EXPECT_FALSE(narrow.bands[3]);
  EXPECT_FALSE(ToJson(narrow).contains("within_6m"));
  EXPECT_EQ(narrow.bands[2]->stray_share, 0.0);
  for (float y = 4.0F; y < 6.1F; y += 0.01F) {
    truth.surface.x_in_truth.push_back({1.0F, y, 0.0F});
    truth.surface.normal.push_back(Eigen::Vector3f::UnitZ());
    truth.surface.visible.push_back(1);
    truth.surface.kind.push_back(0);
  }
  const MapMetrics wide = CompareMap(AlreadyAligned(map, truth));
  EXPECT_EQ(wide.judged, 4U);
  EXPECT_EQ(wide.bands[3]->points, map.size());
  EXPECT_LT(wide.bands[3]->at_tolerance[2].completeness, 1.0);
  EXPECT_EQ(ToJson(wide)["within_6m"]["precision_5cm"], 1.0);
}

TEST(CompareMap, HasNothingToSayOfABandWithoutPoints) {
  MapTruth truth = MakeBeach({});
  auto json = ToJson(CompareMap(AlreadyAligned({{1.0F, 2.0F, 0.0F}}, truth)));
  EXPECT_TRUE(json["within_1.5m"].is_null());
  EXPECT_EQ(json["within_2.5m"]["points"], 1);
  json = ToJson(CompareMap(AlreadyAligned({}, truth)));
  EXPECT_EQ(json["map_points"], 0);
  EXPECT_TRUE(json["within_3.5m"].is_null());
  std::fill(truth.surface.visible.begin(), truth.surface.visible.end(), 0);
  json = ToJson(CompareMap(AlreadyAligned(PerfectMap(truth), truth)));
  EXPECT_TRUE(json["within_3.5m"].is_null());
}

TEST(CompareMap, DoesNotDependOnTheWorldOfTheMap) {
  SeededRandom random;
  const MapTruth truth = MakeBeach({{{1.0, 1.2}, 0.2}});
  Points map = PerfectMap(truth);
  for (auto& x : map) x += random.Noise(0.004).cast<float>();
  const Rigid3 motion = random.Motion(3.0);
  const auto here = CompareMap(AlreadyAligned(map, truth));
  const auto there = CompareMoved({1.0, motion.rotation, motion.translation}, map, truth);
  for (std::size_t b = 0; b < here.judged; ++b) {
    EXPECT_NEAR(there.bands[b]->points, here.bands[b]->points, 10);
    EXPECT_NEAR(there.bands[b]->accuracy_median_m, here.bands[b]->accuracy_median_m, 2e-6);
    EXPECT_NEAR(there.bands[b]->accuracy_p90_m, here.bands[b]->accuracy_p90_m, 2e-6);
    EXPECT_NEAR(there.bands[b]->at_tolerance[0].completeness,
                here.bands[b]->at_tolerance[0].completeness, 1e-4);
  }
}

// The cameras stand 1 m above the sand: a map 2 % too small has it 2 cm too high.
TEST(CompareMap, ShowsAWrongScale) {
  const MapTruth truth = MakeBeach({});
  const Sim3 shrunk_from_truth{0.98, Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.0}};
  const MapMetrics metrics = CompareMoved(shrunk_from_truth, PerfectMap(truth), truth);
  EXPECT_NEAR(metrics.bands[0]->accuracy_median_m, 0.02, 0.002);
}

TEST(AlignWithTruth, LeavesAStraightPathNoRoll) {
  SeededRandom random;
  const MapTruth truth = MakeBeach({});
  const Rigid3 world_from_truth = random.Motion(10.0);
  const auto moved =
      Moved(Sim3{1.0, world_from_truth.rotation, world_from_truth.translation}, truth.path);
  const Rigid3 left = AlignWithTruth(moved, truth.path).value() * world_from_truth;
  EXPECT_LT(AngleOf(left.rotation), 1e-9);
  EXPECT_LT(left.translation.norm(), 1e-9);
}

TEST(AlignWithTruth, NeedsThreePosesOfTheSameTime) {
  const MapTruth truth = MakeBeach({});
  const std::vector<TumPose> two(truth.path.begin(), truth.path.begin() + 2);
  EXPECT_FALSE(AlignWithTruth(two, truth.path));
  auto late = truth.path;
  for (TumPose& pose : late) pose.stamp_ns += 100'000'000;
  EXPECT_FALSE(AlignWithTruth(late, truth.path));
  EXPECT_TRUE(AlignWithTruth(late, truth.path, {.max_dt_s = 0.11}));
}

}  // namespace
}  // namespace rigmap
