// Nearest neighbours and quantiles, against what is plainly so.
#include <gtest/gtest.h>

#include <limits>

#include "core/statistics.h"
#include "evaluation/point_tree.h"
#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

template <class Point>
std::vector<Point> RandomPoints(SeededRandom& random, int count) {
  std::vector<Point> points;
  for (int i = 0; i < count; ++i) {
    points.push_back(random.Vector(1.0)
                         .template head<Point::SizeAtCompileTime>()
                         .template cast<typename Point::Scalar>());
  }
  return points;
}

template <class Point>
void ExpectAsOneByOne() {
  SeededRandom random;
  const auto points = RandomPoints<Point>(random, 500);
  const PointTree<Point> tree(points);
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Matrix<double, Point::SizeAtCompileTime, 1> x =
        random.Vector(1.5).template head<Point::SizeAtCompileTime>();
    const double reach = random.Uniform(0.01, 0.6);
    std::vector<std::uint32_t> all;
    Neighbour nearest{0, kInfinity};
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      const double distance = (points[i].template cast<double>() - x).norm();
      if (distance < nearest.distance) nearest = {i, distance};
      if (distance < reach) all.push_back(i);
    }
    EXPECT_EQ(tree.AllWithin(x, reach), all);
    EXPECT_EQ(tree.Nearest(x, kInfinity).value().index, nearest.index);
    EXPECT_NEAR(tree.Nearest(x, kInfinity)->distance, nearest.distance, 1e-12);
    EXPECT_EQ(tree.Nearest(x, reach).has_value(), !all.empty());
  }
}

TEST(PointTree, FindsWhatLookingOneByOneFinds) {
  ExpectAsOneByOne<Eigen::Vector3f>();
  ExpectAsOneByOne<Eigen::Vector3d>();
  ExpectAsOneByOne<Eigen::Vector2d>();
}

TEST(PointTree, FindsNothingAmongNoPoints) {
  const std::vector<Eigen::Vector3f> none;
  const PointTree<Eigen::Vector3f> tree(none);
  EXPECT_FALSE(tree.Nearest(Eigen::Vector3d::Zero(), kInfinity));
  EXPECT_TRUE(tree.AllWithin(Eigen::Vector3d::Zero(), kInfinity).empty());
}

TEST(PointTree, BearsPointsThatCoincide) {
  const std::vector<Eigen::Vector2d> same(1000, Eigen::Vector2d(1.0, 2.0));
  const PointTree<Eigen::Vector2d> tree(same);
  EXPECT_EQ(tree.Nearest({1.0, 5.0}, 3.5).value().distance, 3.0);
  EXPECT_EQ(tree.AllWithin({1.0, 2.0}, 0.1).size(), 1000U);
}

TEST(InterpolatedQuantile, LiesBetweenTwoValues) {
  const std::vector<double> values{4.0, 1.0, 3.0, 2.0};
  const auto quantile = [&](double share) {
    auto copy = values;
    return InterpolatedQuantile(copy, share);
  };
  EXPECT_EQ(quantile(0.0), 1.0);
  EXPECT_EQ(quantile(0.5), 2.5);
  EXPECT_NEAR(quantile(0.9), 3.7, 1e-12);
  EXPECT_EQ(quantile(1.0), 4.0);
  std::vector<double> one{7.0};
  EXPECT_EQ(InterpolatedQuantile(one, 0.9), 7.0);
}

}  // namespace
}  // namespace rigmap
