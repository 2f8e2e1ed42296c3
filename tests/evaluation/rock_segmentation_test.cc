#include "evaluation/rock_segmentation.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

struct Box {
  Eigen::Vector2d centre;
  double length_m = 0.0, breadth_m = 0.0, height_m = 0.0;

  double Diagonal_m() const { return std::hypot(length_m, breadth_m); }
  bool Covers(const Eigen::Vector2d& position) const {
    const Eigen::Vector2d away = (position - centre).cwiseAbs();
    return away.x() <= 0.5 * length_m && away.y() <= 0.5 * breadth_m;
  }
};

// Six per cent of slope with waves of 4 cm, six metres long.
double Ground_m(const Eigen::Vector2d& position) {
  return 0.05 * position.x() - 0.03 * position.y() +
         0.04 * std::sin(position.x()) * std::cos(position.y());
}

void AddPoint(PointCloud& cloud, double x_m, double y_m, double z_m) {
  cloud.push_back({.x_in_world = Eigen::Vector3d(x_m, y_m, z_m).cast<float>()});
}

// Ground and boxes from above, a point per square centimetre, with normal noise of 4 mm; a box's
// top is level, above the ground at its centre. Ten metres by six.
PointCloud MapOf(const std::vector<Box>& boxes, SeededRandom& random) {
  PointCloud cloud;
  for (double x_m = 0.0; x_m < 10.0; x_m += 0.01) {
    for (double y_m = -3.0; y_m < 3.0; y_m += 0.01) {
      const Eigen::Vector2d position(x_m, y_m);
      const auto box =
          std::ranges::find_if(boxes, [&](const Box& b) { return b.Covers(position); });
      const double z_m =
          box == boxes.end() ? Ground_m(position) : Ground_m(box->centre) + box->height_m;
      AddPoint(cloud, x_m, y_m, z_m + random.Normal(0.004));
    }
  }
  return cloud;
}

const std::vector<Box> kTwoBoxes{{{2.5, 1.0}, 0.40, 0.30, 0.30}, {{6.3, -1.2}, 1.00, 0.60, 0.80}};

void ExpectBoxes(const RockSegmentation& segmentation) {
  ASSERT_EQ(segmentation.rocks.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const SegmentedRock& rock = segmentation.rocks[i];
    const Box& box = kTwoBoxes[1 - i];                   // highest first
    EXPECT_LT((rock.centre - box.centre).norm(), 0.02);  // m
    EXPECT_NEAR(rock.height_m, box.height_m, 0.03);      // noise and waves
    EXPECT_NEAR(rock.top_z_m, Ground_m(box.centre) + box.height_m, 0.02);
    EXPECT_NEAR(rock.width_m, box.Diagonal_m(), 0.04);  // two cells
    EXPECT_NEAR(rock.points, 1e4 * box.length_m * box.breadth_m, 0.06e4);
  }
}

TEST(RockSegmentation, MeasuresBoxesOnWavyGround) {
  SeededRandom random;
  const RockSegmentation segmentation = SegmentRocks(MapOf(kTwoBoxes, random));
  EXPECT_NEAR(segmentation.height_limit_m, 0.08, 0.02);
  ExpectBoxes(segmentation);
}

TEST(RockSegmentation, GroundLevelGoesOnUnderRocks) {
  SeededRandom random;
  HeightGrid grid;
  grid.Add(MapOf(kTwoBoxes, random));
  const GroundLevel ground(grid);
  for (double x_m = 0.5; x_m < 9.5; x_m += 0.3) {
    for (double y_m = -2.5; y_m < 2.5; y_m += 0.3) {
      const auto level_m = ground.At({x_m, y_m});
      ASSERT_TRUE(level_m);
      EXPECT_NEAR(*level_m, Ground_m({x_m, y_m}), 0.03) << x_m << " " << y_m;
    }
  }
  EXPECT_FALSE(ground.At({30.0, 0.0}));
  EXPECT_NEAR(ground.Near({30.0, 0.0}).value(), Ground_m({10.0, 0.0}), 0.1);
}

TEST(RockSegmentation, FlatMapHasNone) {
  SeededRandom random;
  // Tracks, shells and a low step are not rocks.
  const std::vector<Box> low{{{3.0, 0.0}, 0.6, 0.6, 0.05}, {{7.0, 1.0}, 0.05, 0.05, 0.3}};
  EXPECT_TRUE(SegmentRocks(MapOf(low, random)).rocks.empty());
  EXPECT_TRUE(SegmentRocks(PointCloud{}).rocks.empty());
}

// Turned about the vertical and moved, also far and below zero, the rocks move along.
TEST(RockSegmentation, MovesWithTheMap) {
  SeededRandom random;
  const PointCloud cloud = MapOf(kTwoBoxes, random);
  const auto before = SegmentRocks(cloud).rocks;
  for (int run = 0; run < 4; ++run) {
    const Eigen::Rotation2Df turn(static_cast<float>(random.Uniform(-3.0, 3.0)));
    const Eigen::Vector3f move = random.Vector(200.0).cast<float>();
    PointCloud moved = cloud;
    for (SurfacePoint& point : moved) {
      point.x_in_world.head<2>() = turn * point.x_in_world.head<2>();
      point.x_in_world += move;
    }
    const auto after = SegmentRocks(moved).rocks;
    ASSERT_EQ(after.size(), before.size());
    for (std::size_t i = 0; i < before.size(); ++i) {
      const Eigen::Vector2f expected = turn * before[i].centre.cast<float>() + move.head<2>();
      EXPECT_LT((after[i].centre - expected.cast<double>()).norm(), 0.02);  // m
      EXPECT_NEAR(after[i].height_m, before[i].height_m, 0.02);
      EXPECT_NEAR(after[i].width_m, before[i].width_m, 0.04);
    }
  }
}

TEST(RockSegmentation, StrayPointsMakeNoRockAndNoTop) {
  SeededRandom random;
  PointCloud cloud = MapOf(kTwoBoxes, random);
  for (int i = 0; i < 300; ++i) {
    AddPoint(cloud, random.Uniform(0.0, 10.0), random.Uniform(-3.0, 3.0), random.Uniform(0.0, 2.0));
  }
  AddPoint(cloud, 2.5, 1.0, 3.0);
  AddPoint(cloud, std::nan(""), 0.0, 0.0);
  AddPoint(cloud, 3e7, 0.0, 0.0);
  ExpectBoxes(SegmentRocks(cloud));
}

TEST(RockSegmentation, ShowsOfARockWhatTheMapShows) {
  SeededRandom random;
  const Box& box = kTwoBoxes[1];
  PointCloud cloud = MapOf(kTwoBoxes, random);
  // Seen from x = 0: the far two thirds of the box and the ground behind it are hidden.
  std::erase_if(cloud, [&](const SurfacePoint& point) {
    const Eigen::Vector2d away = point.x_in_world.head<2>().cast<double>() - box.centre;
    return away.x() > -box.length_m / 6.0 && std::abs(away.y()) < 0.5 * box.breadth_m + 0.2;
  });
  const auto rocks = SegmentRocks(cloud).rocks;
  ASSERT_EQ(rocks.size(), 2U);
  EXPECT_NEAR(rocks[0].width_m, std::hypot(box.length_m / 3.0, box.breadth_m), 0.04);
  EXPECT_NEAR(rocks[0].centre.x(), box.centre.x() - box.length_m / 3.0, 0.02);
  EXPECT_NEAR(rocks[0].height_m, box.height_m, 0.05);
}

TEST(RockSegmentation, PiecesMakeTheSameMapInLittleMemory) {
  SeededRandom random;
  const PointCloud cloud = MapOf(kTwoBoxes, random);
  HeightGrid whole, pieces;
  whole.Add(cloud);
  for (std::size_t i = 0; i < cloud.size(); i += 1000) {
    pieces.Add(std::span(cloud).subspan(i, std::min<std::size_t>(1000, cloud.size() - i)));
  }
  // Sixty square metres.
  constexpr double kTile_m = kHeightCell_m * kTileCells;
  EXPECT_LE(static_cast<double>(whole.tiles().size()) * kTile_m * kTile_m, 60.0 * 1.15);
  ExpectBoxes(SegmentRocks(pieces));
  EXPECT_EQ(SegmentRocks(whole).rocks[0].width_m, SegmentRocks(pieces).rocks[0].width_m);
}

TEST(RockSegmentation, FindsTheCellOfAPosition) {
  HeightGrid grid;
  PointCloud cloud;
  AddPoint(cloud, -0.01, -0.33, 0.5);
  AddPoint(cloud, -0.011, -0.331, 0.7);
  grid.Add(cloud);
  const HeightCell* cell = grid.Find({-1, -17});
  ASSERT_NE(cell, nullptr);
  EXPECT_EQ(cell->points, 2U);
  EXPECT_FLOAT_EQ(cell->top_m, 0.7F);
  EXPECT_FLOAT_EQ(cell->mean_m, 0.6F);
  EXPECT_LT((CentreOf({-1, -17}) - Eigen::Vector2d(-0.01, -0.33)).norm(), 1e-12);
  EXPECT_EQ(grid.Find({0, -17}), nullptr);
  EXPECT_EQ(grid.Find({-1, 17}), nullptr);
  ASSERT_EQ(grid.tiles().size(), 1U);
  EXPECT_EQ(grid.tiles().begin()->first, TileOf({-0.01, -0.33}));
}

TEST(RockSegmentation, RefusesOptionsOutOfRange) {
  RockSegmentationOptions options;
  options.min_height_m = 0.0;
  EXPECT_THROW(SegmentRocks(PointCloud{}, options), UsageError);
}

}  // namespace
}  // namespace rigmap
