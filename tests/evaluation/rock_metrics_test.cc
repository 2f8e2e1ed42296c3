#include "evaluation/rock_metrics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/evaluation/synthetic_beach.h"

namespace rigmap {
namespace {

const Dome kDome{{1.0, 1.5}, 0.25};
constexpr double kTopTolerance_m = 0.003;  // a 200th of the points may lie higher

Points Rock(const MapTruth& truth) {
  Points points;
  for (std::size_t i = 0; i < truth.surface.size(); ++i) {
    if (truth.surface.kind[i] == kRockKind) points.push_back(truth.surface.x_in_truth[i]);
  }
  return points;
}

Points Sand(const MapTruth& truth) {
  Points points;
  for (std::size_t i = 0; i < truth.surface.size(); ++i) {
    if (truth.surface.kind[i] != kRockKind) points.push_back(truth.surface.x_in_truth[i]);
  }
  return points;
}

Points Together(Points points, const Points& more) {
  points.insert(points.end(), more.begin(), more.end());
  return points;
}

RockMetrics OnlyRock(const Points& map, const MapTruth& truth) {
  const auto rocks = CompareRocks(AlreadyAligned(map, truth));
  if (rocks.size() != 1) throw std::runtime_error("expected one rock");
  return rocks.front();
}

TEST(CompareRocks, FindsNoErrorInTheTruth) {
  const MapTruth truth = MakeBeach({kDome});
  const RockMetrics rock = OnlyRock(PerfectMap(truth), truth);
  EXPECT_EQ(rock.visible_points, Rock(truth).size());
  EXPECT_EQ(rock.completeness, 1.0);
  EXPECT_TRUE(rock.Found());
  EXPECT_EQ(rock.ghost_share, 0.0);
  EXPECT_LT(rock.deformation.value().shift_m, 1e-3);
  EXPECT_NEAR(rock.top_m.value(), 0.0, kTopTolerance_m);
}

// Without the sand beside it: points of that count as matches of the rock's foot too.
TEST(CompareRocks, FindsNoStretchInTheTrueRock) {
  const MapTruth truth = MakeBeach({kDome});
  const auto found = OnlyRock(Rock(truth), truth).deformation.value();
  EXPECT_LT(found.shift_m, 1e-6);
  EXPECT_LT((found.stretch - Eigen::Vector3d::Ones()).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(CompareRocks, MeasuresAShift) {
  const MapTruth truth = MakeBeach({kDome});
  const Points map = Together(Sand(truth), Displaced(Rock(truth), {0.006F, 0.008F, 0.0F}));
  EXPECT_NEAR(OnlyRock(map, truth).deformation.value().shift_m, 0.010, 0.001);
}

TEST(CompareRocks, MeasuresAStretchAlongTheView) {
  const MapTruth truth = MakeBeach({kDome});
  Points rock = Rock(truth);  // seen along y, from (1, 0)
  for (auto& x : rock) x.y() = 1.5F + 1.04F * (x.y() - 1.5F);
  const auto found = OnlyRock(rock, truth).deformation.value();
  EXPECT_NEAR(found.stretch.x(), 1.04, 0.006);
  EXPECT_NEAR(found.stretch.y(), 1.00, 0.006);
  EXPECT_NEAR(found.stretch.z(), 1.00, 0.006);
  EXPECT_LT(found.sigma_stretch.maxCoeff(), 0.02);
  const auto json = ToJson(CompareRocks(AlreadyAligned(rock, truth)));
  EXPECT_NEAR(json["stretch_max_off"].get<double>(), 0.04, 0.006);
}

TEST(CompareRocks, MeasuresTheTop) {
  const MapTruth truth = MakeBeach({kDome});
  Points rock = Rock(truth);
  for (auto& x : rock) x.z() *= 1.12F;
  const auto metrics = OnlyRock(rock, truth);
  EXPECT_NEAR(metrics.top_m.value(), 0.03, kTopTolerance_m);
  EXPECT_NEAR(metrics.deformation.value().stretch.z(), 1.12, 0.015);
}

TEST(CompareRocks, SeesASecondCopyAsGhosts) {
  const MapTruth truth = MakeBeach({kDome});
  const Points copy = Displaced(Rock(truth), {0.0F, 0.0F, 0.15F});
  const RockMetrics rock = OnlyRock(Together(PerfectMap(truth), copy), truth);
  // What of the copy lies over 4 cm outside the ball, and what of rock and copy over the sand.
  const Eigen::Vector3f centre(1.0F, 1.5F, 0.0F);
  const double ghosts = static_cast<double>(std::count_if(
      copy.begin(), copy.end(), [&](const auto& x) { return (x - centre).norm() > 0.29F; }));
  const Points once = Rock(truth);
  const double above = static_cast<double>(
      std::count_if(once.begin(), once.end(), [](const auto& x) { return x.z() > 0.05F; }));
  EXPECT_NEAR(rock.ghost_share.value(), ghosts / (above + static_cast<double>(copy.size())), 0.01);
  EXPECT_GT(*rock.ghost_share, 0.2);
  EXPECT_EQ(rock.completeness, 1.0);
}

TEST(CompareRocks, CountsHalfARockAsFoundAndLessAsNot) {
  const MapTruth truth = MakeBeach({kDome});
  for (const float share : {0.35F, 0.65F}) {
    Points part;
    for (const auto& x : Rock(truth)) {
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
  EXPECT_TRUE(json["shift_max_mm"].is_null());
  EXPECT_FALSE(json["each"][0].contains("stretch"));
  EXPECT_FALSE(json["each"][0].contains("ghost_pct"));
}

TEST(CompareRocks, GivesTouchingRocksTheirOwnPoints) {
  const MapTruth truth = MakeBeach({{{1.0, 1.2}, 0.25}, {{1.5, 1.2}, 0.25}});
  const auto rocks = CompareRocks(AlreadyAligned(PerfectMap(truth), truth));
  ASSERT_EQ(rocks.size(), 2U);
  EXPECT_EQ(rocks[0].visible_points + rocks[1].visible_points, Rock(truth).size());
  EXPECT_NEAR(static_cast<double>(rocks[0].visible_points),
              static_cast<double>(rocks[1].visible_points), 20.0);
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

}  // namespace
}  // namespace rigmap
