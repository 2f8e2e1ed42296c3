#include "geometry/triangulation.h"

#include <gtest/gtest.h>

#include <numbers>
#include <vector>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

// A rig about as wide as a rover's, slightly toed in.
Rigid3 RightFromLeft() {
  return {ExpRotation({0.002, -0.01, 0.003}), Eigen::Vector3d(-0.12, 0.001, -0.002)};
}

View Seen(const Rigid3& camera_from_world, const Eigen::Vector3d& x_in_world) {
  return {camera_from_world, (camera_from_world * x_in_world).hnormalized()};
}

Eigen::Vector3d PointAhead(SeededRandom& random) {
  return {random.Uniform(-2.0, 2.0), random.Uniform(-1.0, 1.0), random.Uniform(2.0, 12.0)};
}

std::vector<View> ViewsOf(const Eigen::Vector3d& x_in_world, int count, SeededRandom& random) {
  std::vector<View> views;
  for (int i = 0; i < count; ++i) {
    views.push_back(Seen(random.Motion(0.5, 0.2).Inverse(), x_in_world));
  }
  return views;
}

double SquaredReprojection(const std::vector<View>& views, const Eigen::Vector3d& x) {
  double sum = 0.0;
  for (const View& view : views) {
    sum += ((view.camera_from_world * x).hnormalized() - view.normalised).squaredNorm();
  }
  return sum;
}

TEST(Triangulate, FindsExactPoints) {
  SeededRandom random;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d x_in_world = PointAhead(random);
    const auto found = Triangulate(ViewsOf(x_in_world, 2 + i % 6, random));
    ASSERT_TRUE(found);
    EXPECT_LT((*found - x_in_world).norm(), 1e-7);
  }
}

TEST(Triangulate, DoesNotDependOnTheWorldFrame) {
  SeededRandom random;
  const Eigen::Vector3d x_in_world = PointAhead(random);
  std::vector<View> views = ViewsOf(x_in_world, 4, random);
  for (View& view : views) {
    view.normalised += Eigen::Vector2d(random.Normal(1e-3), random.Normal(1e-3));
  }
  const auto found = Triangulate(views);
  const Rigid3 other_from_world = random.Motion(100.0);
  for (View& view : views)
    view.camera_from_world = view.camera_from_world * other_from_world.Inverse();
  const auto found_in_other = Triangulate(views);
  ASSERT_TRUE(found && found_in_other);
  EXPECT_LT((*found_in_other - other_from_world * *found).norm(), 1e-6);
}

TEST(Triangulate, NoNeighbourReprojectsNoisyViewsBetter) {
  SeededRandom random;
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector3d x_in_world = PointAhead(random);
    std::vector<View> views = ViewsOf(x_in_world, 5, random);
    for (View& view : views) {
      view.normalised += Eigen::Vector2d(random.Normal(1e-3), random.Normal(1e-3));
    }
    const auto found = Triangulate(views);
    ASSERT_TRUE(found);
    const double least = SquaredReprojection(views, *found);
    for (int k = 0; k < 50; ++k) {
      EXPECT_GE(SquaredReprojection(views, *found + random.Noise(1e-3)), least * (1.0 - 1e-9));
    }
  }
}

TEST(Triangulate, FindsNothingBehindACamera) {
  const Eigen::Vector3d x_in_world(0.3, 0.1, -4.0);
  EXPECT_FALSE(Triangulate(
      std::vector<View>{Seen(Rigid3(), x_in_world), Seen(RightFromLeft(), x_in_world)}));
}

TEST(Triangulate, FindsNothingWhereRaysRunParallelOrApart) {
  const Rigid3 right_from_left{Eigen::Quaterniond::Identity(), {-0.12, 0.0, 0.0}};
  EXPECT_FALSE(TriangulateStereo(right_from_left, {0.1, 0.2}, {0.1, 0.2}));
  EXPECT_FALSE(TriangulateStereo(right_from_left, {0.1, 0.2}, {0.15, 0.2}));
}

TEST(Triangulate, FindsNothingFromOneView) {
  EXPECT_FALSE(Triangulate(std::vector<View>{Seen(Rigid3(), {0.1, 0.2, 3.0})}));
  EXPECT_FALSE(Triangulate(std::vector<View>{}));
}

TEST(TriangulateStereo, AnswersInLeftAxesAndScalesWithTheRig) {
  SeededRandom random;
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d x_in_left = PointAhead(random);
    Rigid3 right_from_left = RightFromLeft();
    const Eigen::Vector2d left = x_in_left.hnormalized();
    const Eigen::Vector2d right = (right_from_left * x_in_left).hnormalized();
    const auto found = TriangulateStereo(right_from_left, left, right);
    right_from_left.translation *= 2.0;
    const auto doubled = TriangulateStereo(right_from_left, left, right);
    ASSERT_TRUE(found && doubled);
    EXPECT_LT((*found - x_in_left).norm(), 1e-7);
    EXPECT_LT((*doubled - 2.0 * x_in_left).norm(), 1e-7);
  }
}

}  // namespace
}  // namespace rigmap
