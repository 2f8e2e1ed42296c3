// Which rocks are judged, by which points, and what is said of them.
#include "evaluation/rock_metrics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/evaluation/synthetic_beach.h"

namespace rigmap {
namespace {

TEST(CompareRocks, CountsHalfARockAsFoundAndLessAsNot) {
  const MapTruth truth = MakeBeach({kDome});
  for (const float share : {0.35F, 0.65F}) {
    Points part;
    for (const auto& x : PointsOfKind(truth, true)) {
      if (x.x() < 0.75F + 0.5F * share) part.push_back(x);
    }
    const RockMetrics rock = OnlyRock(part, truth);
    EXPECT_NEAR(rock.completeness, share, 0.08);
    EXPECT_EQ(rock.Found(), share > 0.5F);
  }
}

TEST(CompareRocks, SaysOfAMissingRockThatItIsMissing) {
  const MapTruth truth = MakeBeach({kDome});
  const auto json = ToJson(CompareRocks(AlreadyAligned({}, truth)));
  EXPECT_EQ(json["rocks"], 1);
  EXPECT_EQ(json["found"], 0);
  EXPECT_EQ(json["stretch_counted"], 0);
  for (const char* key : {"shift_max_mm", "stretch_max_off", "top_max_mm", "ghost_max_pct",
                          "ghost_4cm_max_pct", "doubled_max_pct"}) {
    EXPECT_TRUE(json[key].is_null()) << key;
  }
  const auto& rock = json["each"][0];
  for (const char* key : {"shift_mm", "stretch", "sigma_stretch", "top_mm", "ghost_pct"}) {
    EXPECT_TRUE(rock.contains(key) && rock[key].is_null()) << key;
  }
  for (const char* key : {"shift_vector_mm", "rms_mm", "doubled_pct", "ghost_4cm_pct"}) {
    EXPECT_FALSE(rock.contains(key)) << key;
  }
}

TEST(CompareRocks, GivesTouchingRocksTheirOwnPoints) {
  const MapTruth truth = MakeBeach({{{1.0, 1.2}, 0.25}, {{1.5, 1.2}, 0.25}});
  const auto rocks = CompareRocks(AlreadyAligned(PerfectMap(truth), truth));
  ASSERT_EQ(rocks.size(), 2U);
  EXPECT_EQ(rocks[0].visible_points + rocks[1].visible_points, PointsOfKind(truth, true).size());
  EXPECT_NEAR(static_cast<double>(rocks[0].visible_points),
              static_cast<double>(rocks[1].visible_points), 20.0);
}

// Where a neighbour is shifted, only what is 5 cm from it counts.
TEST(CompareRocks, DoesNotTakeANeighbourForTheRock) {
  const Dome first{{1.0, 1.2}, 0.25}, second{{1.5, 1.2}, 0.25};
  const MapTruth truth = MakeBeach({first, second});
  Points map = PerfectMap(truth);
  for (auto& x : map) {
    if (x.x() > 1.25F && x.z() > 0.0F) x.z() += 0.02F;
  }
  const auto rocks = CompareRocks(AlreadyAligned(map, truth));
  ASSERT_EQ(rocks.size(), 2U);
  EXPECT_LT(rocks[0].shift.value().along_axes_m.norm(), 0.001);
  EXPECT_NEAR(rocks[1].shift.value().along_axes_m.z(), 0.02, 0.001);
}

TEST(CompareRocks, LeavesOutRocksThatAreFarOrHardlyVisible) {
  EXPECT_TRUE(CompareRocks(AlreadyAligned({}, MakeBeach({{{1.0, 3.6}, 0.25}}))).empty());
  EXPECT_TRUE(CompareRocks(AlreadyAligned({}, MakeBeach({{{1.0, 1.0}, 0.1}}))).empty());
  MapTruth hidden = MakeBeach({kDome});
  std::fill(hidden.surface.visible.begin(), hidden.surface.visible.end(), 0);
  EXPECT_TRUE(CompareRocks(AlreadyAligned(PerfectMap(hidden), hidden)).empty());
}

TEST(CompareRocks, AnswersWhereThereIsNoRock) {
  const MapTruth truth = MakeBeach({});
  const auto json = ToJson(CompareRocks(AlreadyAligned(PerfectMap(truth), truth)));
  EXPECT_EQ(json["rocks"], 0);
  EXPECT_TRUE(json["ghost_max_pct"].is_null());
  EXPECT_TRUE(json["each"].is_array() && json["each"].empty());
}

// A list of rocks that does not fit the surface: the only rock of the list stands elsewhere.
TEST(CompareRocks, SaysOfARockWithoutASurfaceThatItIsMissing) {
  MapTruth truth = MakeBeach({kDome});
  truth.rocks[0].x_in_truth.y() -= 3.0;
  const RockMetrics rock = OnlyRock(PerfectMap(truth), truth);
  EXPECT_EQ(rock.visible_points, 0U);
  EXPECT_FALSE(rock.Found());
  EXPECT_FALSE(rock.shift || rock.stretch || rock.top_m || rock.ghosts);
}

RockMetrics FittedRock(double stretch, double sigma, double top_m) {
  RockMetrics rock{.completeness = 1.0, .top_m = top_m};
  rock.stretch = RockStretch{Eigen::Vector3d(stretch, 1.001, 0.9),
                             Eigen::Vector3d(sigma, 0.003, 0.05), 0.002, 0.1};
  return rock;
}

TEST(RocksJson, TakesTheWorstOfStretchesThatAreKnownAndTheMagnitudeOfTops) {
  const auto json = ToJson({FittedRock(0.97, 0.019, -0.012), FittedRock(1.08, 0.021, 0.004)});
  EXPECT_EQ(json["stretch_max_off"], 0.03);
  EXPECT_EQ(json["stretch_counted"], 3);
  EXPECT_EQ(json["top_max_mm"], 12.0);
  EXPECT_EQ(json["doubled_max_pct"], 10.0);
  EXPECT_TRUE(json["shift_max_mm"].is_null());
}

TEST(RocksJson, SaysZeroWhereFittedStretchesAreAllUnknown) {
  RockMetrics rock = FittedRock(1.08, 0.03, 0.0);
  rock.stretch->sigma.setConstant(0.03);
  const auto json = ToJson({rock});
  EXPECT_EQ(json["stretch_max_off"], 0.0);
  EXPECT_EQ(json["stretch_counted"], 0);
}

}  // namespace
}  // namespace rigmap
