#include "matching/internal/loop_closure_motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "correspondence/ground_warp.h"
#include "tests/support/seeded_random.h"
#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

// Two views of one ground, the second turned by 150 degrees about the middle of what the first
// sees.
SyntheticRover TurnedViews() {
  constexpr double kTurn_rad = 150.0 * std::numbers::pi / 180.0, kAhead_m = 3.0;
  return MakeSyntheticRover(
      {.points_per_m2 = 12.0, .relief_m = 0.0, .pixel_sigma = 0.1},
      {RoverPose(0.0, 0.0, 0.0), RoverPose(kAhead_m * (1.0 - std::cos(kTurn_rad)),
                                           -kAhead_m * std::sin(kTurn_rad), kTurn_rad)});
}

SearchedFrame ViewOf(const SyntheticRover& rover, int frame) {
  SearchedFrame view{.features = rover.frames[frame]};
  view.points = TriangulateFeatures(view.features.features, rover.rig, 0.15);
  view.groups.assign(view.features.features.size(), 0);
  return view;
}

Rigid3 TrueMotion(const SyntheticRover& rover) {
  return rover.world_from_left[1].Inverse() * rover.world_from_left[0];
}

TEST(LoopClosureMotion, IsFoundWithoutPrediction) {
  const SyntheticRover rover = TurnedViews();
  const auto motion = MotionWithoutPrediction(ViewOf(rover, 0), ViewOf(rover, 1), rover.rig, {});
  ASSERT_TRUE(motion);
  const Rigid3 error = motion->current_from_reference * TrueMotion(rover).Inverse();
  EXPECT_LT(error.translation.norm(), 0.03);
  EXPECT_LT(AngleOf(error.rotation), 0.01);
  EXPECT_GT(motion->inlier_count, 30);
}

TEST(LoopClosureMotion, IsFoundAmongNineWrongMatchesOfTen) {
  SeededRandom random;
  const SyntheticRover rover = TurnedViews();
  const SearchedFrame a = ViewOf(rover, 0), b = ViewOf(rover, 1);
  std::vector<FeatureMatch> matches;
  for (const auto& [of_a, of_b] : TrueMatches(rover, 0, 1)) {
    if (a.points[of_a] && b.points[of_b] && matches.size() < 30) matches.push_back({of_a, of_b});
  }
  ASSERT_EQ(matches.size(), 30u);
  const auto any = [&](std::size_t count) {
    return static_cast<int>(random.Uniform(0.0, static_cast<double>(count)));
  };
  while (matches.size() < 300) matches.push_back({any(a.points.size()), any(b.points.size())});
  const auto motions = MotionsOfAgreeingMatches(matches, a.points, b.points);
  ASSERT_FALSE(motions.empty());
  const bool found = std::ranges::any_of(motions, [&](const Rigid3& motion) {
    const Rigid3 error = motion * TrueMotion(rover).Inverse();
    return error.translation.norm() < 0.2 && AngleOf(error.rotation) < 0.06;
  });
  EXPECT_TRUE(found);
}

TEST(LoopClosureMotion, OtherGroundHasNone) {
  SeededRandom random;
  SyntheticRover rover = TurnedViews();
  // Descriptors that look like those of the first frame, but at random places.
  auto& descriptors = rover.frames[1].descriptors;
  for (std::size_t i = descriptors.size() - 1; i > 0; --i) {
    const auto other = static_cast<std::size_t>(random.Uniform(0.0, static_cast<double>(i + 1)));
    std::swap(descriptors[i], descriptors[other]);
  }
  EXPECT_FALSE(MotionWithoutPrediction(ViewOf(rover, 0), ViewOf(rover, 1), rover.rig, {}));
  EXPECT_FALSE(MotionWithoutPrediction(SearchedFrame{}, ViewOf(rover, 1), rover.rig, {}));
}

TEST(LoopClosureMotion, OnlyFeaturesOfAGroupMatch) {
  const SyntheticRover rover = TurnedViews();
  const SearchedFrame a = ViewOf(rover, 0);
  SearchedFrame b = ViewOf(rover, 1);
  std::ranges::fill(b.groups, 1);
  EXPECT_FALSE(MotionWithoutPrediction(a, b, rover.rig, {}));
}

TEST(GroundWarp, IsHowNeighbouringPointsMove) {
  const SyntheticRover rover = TurnedViews();
  const SearchedFrame a = ViewOf(rover, 0);
  const Camera& camera = rover.rig.left.camera;
  int checked = 0;
  for (const auto& [of_a, of_b] : TrueMatches(rover, 0, 1)) {
    if (!a.points[of_a] || a.points[of_a]->x_in_left.z() > 4.0) continue;
    const auto ground = GroundAround(a.features.features, a.points, of_a, 0);
    ASSERT_TRUE(ground);
    const auto warp = GroundWarp(*ground, TrueMotion(rover), camera);
    ASSERT_TRUE(warp);
    // The ground is flat: a spot a little to the side of the true point, seen by both cameras.
    const Eigen::Vector3d& x = rover.points[rover.point_of_feature[0][of_a]];
    const Eigen::Vector3d aside = x + Eigen::Vector3d(0.01, 0.01, 0.0);
    const auto pixel = [&](int frame, const Eigen::Vector3d& in_world) {
      return *Project(camera, rover.world_from_left[frame].Inverse() * in_world);
    };
    const Eigen::Vector2d in_a = pixel(0, aside) - pixel(0, x);
    const Eigen::Vector2d in_b = pixel(1, aside) - pixel(1, x);
    EXPECT_LT((warp->linear * in_a - in_b).norm(), 0.35 * in_b.norm());
    ++checked;
  }
  EXPECT_GT(checked, 10);
}

// Level ground, 9 m away and 1 m below, whose disparities are off by 0.15 px: least distances would
// turn it by 0.7 degrees towards the eye.
TEST(GroundWarp, FarGroundStaysLevel) {
  SeededRandom random;
  const StereoRig rig = LocCamRig();
  const double disparity_m = rig.left.camera.MeanFocal() * rig.Baseline();
  constexpr double kFar_m = 9.0, kDown_m = 1.0, kNoise_px = 0.15;
  const double row = kDown_m / kFar_m;
  double turned_rad = 0.0;
  constexpr int kTrials = 400;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<Feature> features;
    std::vector<std::optional<StereoPoint>> points;
    for (int i = 0; i < 20; ++i) {
      const Eigen::Vector2d spot(random.Uniform(-0.008, 0.008),
                                 row + random.Uniform(-0.008, 0.008));
      const double nearness =
          spot.y() / kDown_m + random.Uniform(-1.7, 1.7) * kNoise_px / disparity_m;
      features.push_back({.left = *Project(rig.left.camera, spot.homogeneous())});
      points.push_back(StereoPoint{spot.homogeneous() / nearness, 0.1});
    }
    const auto ground = GroundAround(features, points, 0, 0);
    ASSERT_TRUE(ground);
    const Eigen::Vector3d normal = ground->normal.y() > 0.0 ? ground->normal : -ground->normal;
    turned_rad += std::atan2(normal.z(), normal.y()) / kTrials;
  }
  EXPECT_LT(std::abs(turned_rad), 0.2 * std::numbers::pi / 180.0);
}

TEST(GroundWarp, BendsAsPlaneAndLensDo) {
  SeededRandom random;
  const Camera camera = LocCamRig().left.camera;
  for (int trial = 0; trial < 50; ++trial) {
    const Eigen::Vector2d centre(std::round(random.Uniform(100, 900)),
                                 std::round(random.Uniform(400, 700)));
    const Eigen::Vector3d ray = Undistort(camera, centre)->homogeneous();
    const GroundPatch patch{0, centre, 2.0 * ray, Eigen::Vector3d(0.05, -0.94, -0.33).normalized()};
    const Rigid3 b_from_a{ExpRotation({0.0, random.Uniform(-0.1, 0.1), 0.0}), {0.0, 0.1, -0.4}};
    const auto warp = GroundWarp(patch, b_from_a, camera);
    ASSERT_TRUE(warp);
    double without_bend_px = 0.0;
    for (int i = 0; i < 10; ++i) {
      const Eigen::Vector2d u(random.Uniform(-6, 6), random.Uniform(-6, 6));
      const Eigen::Vector3d direction = Undistort(camera, centre + u)->homogeneous();
      const Eigen::Vector3d on_plane =
          patch.normal.dot(patch.x) / patch.normal.dot(direction) * direction;
      const Eigen::Vector2d truth = *Project(camera, b_from_a * on_plane);
      EXPECT_LT((*warp * u - truth).norm(), 0.01);
      without_bend_px =
          std::max(without_bend_px, (warp->position + warp->linear * u - truth).norm());
    }
    EXPECT_GT(without_bend_px, 0.004);
  }
}

TEST(DepthChange, IsThatOfThePlane) {
  const Camera camera = LocCamRig().left.camera;
  const Eigen::Vector2d centre(700, 450);
  const Eigen::Vector3d normal = Eigen::Vector3d(0.3, -0.9, -0.1).normalized();
  const Eigen::Vector3d x = 6.0 * Undistort(camera, centre)->homogeneous();
  const Eigen::Array2d change = DepthChange({0, centre, x, normal}, camera);
  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::Vector3d next =
        Undistort(camera, centre + Eigen::Vector2d::Unit(axis))->homogeneous();
    const double depth_m = normal.dot(x) / normal.dot(next);
    EXPECT_NEAR(change(axis), std::abs(6.0 / depth_m - 1.0), 1e-9);
    EXPECT_GT(change(axis), 1e-4);
  }
  // Through the eye: nothing to go by.
  const Eigen::Vector3d edge_on = x.cross(Eigen::Vector3d::UnitX()).normalized();
  EXPECT_TRUE(DepthChange({0, centre, x, edge_on}, camera).isFinite().all());
}

TEST(GroundWarp, IsTheSameWhereNothingMoves) {
  const SyntheticRover rover = TurnedViews();
  const SearchedFrame a = ViewOf(rover, 0);
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    if (!a.points[i]) continue;
    const auto ground = GroundAround(a.features.features, a.points, static_cast<int>(i), 0);
    const auto warp = GroundWarp(ground.value(), Rigid3(), rover.rig.left.camera);
    if (!warp) continue;
    EXPECT_LT((warp->linear - Eigen::Matrix2d::Identity()).norm(), 1e-6);
    EXPECT_LT(warp->bend.norm(), 1e-6);
  }
  const std::vector<std::optional<StereoPoint>> alone(a.points.size(), std::nullopt);
  EXPECT_FALSE(GroundAround(a.features.features, alone, 0, 0));
}

}  // namespace
}  // namespace rigmap
