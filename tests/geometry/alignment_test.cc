#include "geometry/alignment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

using Points = std::vector<Eigen::Vector3d>;

Points Scatter(SeededRandom& random, int count, double reach) {
  Points points;
  for (int i = 0; i < count; ++i) points.push_back(random.Vector(reach));
  return points;
}

Points Moved(const Sim3& to_from_from, const Points& points) {
  Points moved;
  for (const auto& point : points) moved.push_back(to_from_from * point);
  return moved;
}

double SquaredError(const Sim3& to_from_from, const Points& from, const Points& to) {
  double sum = 0.0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    sum += (to_from_from * from[i] - to[i]).squaredNorm();
  }
  return sum;
}

void ExpectNear(const Sim3& found, const Sim3& expected, double tolerance) {
  EXPECT_NEAR(found.scale, expected.scale, tolerance * expected.scale);
  EXPECT_LT(AngleOf(found.rotation.conjugate() * expected.rotation), tolerance);
  EXPECT_LT((found.translation - expected.translation).norm(), 100.0 * tolerance);
}

TEST(AlignPoints, RecoversARandomSimilarity) {
  SeededRandom random;
  for (int i = 0; i < 100; ++i) {
    const Sim3 to_from_from = random.Similarity(20.0);
    const Points from = Scatter(random, 4 + i % 20, 5.0);
    ExpectNear(AlignPoints(from, Moved(to_from_from, from), true), to_from_from, 1e-10);
  }
}

TEST(AlignPoints, RecoversFromPointsInAPlane) {
  SeededRandom random;
  for (int i = 0; i < 100; ++i) {
    const Sim3 to_from_from = random.Similarity(20.0);
    Points from = Scatter(random, 3 + i % 5, 5.0);
    for (auto& point : from) point.z() = 0.0;
    ExpectNear(AlignPoints(from, Moved(to_from_from, from), true), to_from_from, 1e-7);
  }
}

TEST(AlignPoints, WithoutScaleHoldsItAtOne) {
  SeededRandom random;
  const Rigid3 motion = random.Motion(20.0);
  const Points from = Scatter(random, 20, 5.0);
  Sim3 stretched{1.3, motion.rotation, motion.translation};
  const Sim3 found = AlignPoints(from, Moved(stretched, from), false);
  EXPECT_EQ(found.scale, 1.0);
  EXPECT_LT(AngleOf(found.rotation.conjugate() * motion.rotation), 1e-10);
}

TEST(AlignPoints, AnswersMirroredPointsWithARotation) {
  SeededRandom random;
  const Points from = Scatter(random, 20, 5.0);
  Points to = from;
  for (auto& point : to) point.x() = -point.x();
  const Sim3 found = AlignPoints(from, to, true);
  EXPECT_NEAR(found.rotation.toRotationMatrix().determinant(), 1.0, 1e-12);
  EXPECT_GT(SquaredError(found, from, to), 1.0);
}

// With noise, no similarity nearby may fit better than the one found.
TEST(AlignPoints, NoNeighbourFitsNoisyPointsBetter) {
  SeededRandom random;
  const Sim3 to_from_from = random.Similarity(20.0);
  const Points from = Scatter(random, 30, 5.0);
  Points to = Moved(to_from_from, from);
  for (auto& point : to) point += random.Noise(0.1);
  const Sim3 found = AlignPoints(from, to, true);
  ExpectNear(found, to_from_from, 0.02);
  const double least = SquaredError(found, from, to);
  for (int i = 0; i < 200; ++i) {
    const Sim3 step{1.0 + random.Normal(1e-4), ExpRotation(random.Noise(1e-4)), random.Noise(1e-4)};
    EXPECT_GE(SquaredError(step * found, from, to), least);
  }
}

TEST(AlignPoints, FitsPointsOnALine) {
  SeededRandom random;
  const Sim3 to_from_from = random.Similarity(20.0);
  Points from;
  for (int i = 0; i < 10; ++i) from.emplace_back(0.5 * i, -0.2 * i, 0.1 * i);
  const Points to = Moved(to_from_from, from);
  EXPECT_LT(std::sqrt(SquaredError(AlignPoints(from, to, true), from, to)), 1e-10);
}

TEST(AlignPoints, RefusesTooFewOrUnequalLists) {
  const Points two(2, Eigen::Vector3d::Zero()), three(3, Eigen::Vector3d::Zero());
  EXPECT_THROW(AlignPoints(two, two, true), std::invalid_argument);
  EXPECT_THROW(AlignPoints(two, three, true), std::invalid_argument);
}

}  // namespace
}  // namespace rigmap
