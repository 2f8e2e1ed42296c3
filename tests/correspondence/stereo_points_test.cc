#include "correspondence/stereo_points.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/seeded_random.h"
#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

// What both eyes see of a point in front of them.
Feature Seen(const StereoRig& rig, const Eigen::Vector3d& x_in_left) {
  Feature feature{.left = *Project(rig.left.camera, x_in_left)};
  const auto right = Project(rig.right.camera, rig.right_from_left * x_in_left);
  if (right) feature.right = *right;
  return feature;
}

Eigen::Vector3d PointInView(SeededRandom& random) {
  const double z_m = random.Uniform(0.8, 20.0);
  return {z_m * random.Uniform(-0.4, 0.4), z_m * random.Uniform(-0.3, 0.3), z_m};
}

TEST(TriangulateFeatures, BringsPointsBack) {
  SeededRandom random;
  const StereoRig rig = LocCamRig();
  std::vector<Eigen::Vector3d> truth;
  std::vector<Feature> features;
  for (int i = 0; i < 200; ++i) {
    truth.push_back(PointInView(random));
    features.push_back(Seen(rig, truth.back()));
  }
  const auto points = TriangulateFeatures(features, rig, 0.15);
  ASSERT_EQ(points.size(), features.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    ASSERT_TRUE(points[i]) << i;
    EXPECT_LT((points[i]->x_in_left - truth[i]).norm(), 1e-6 * truth[i].z());
  }
}

TEST(NearDepth, IsTheTwentiethPartOfStereoPointsThatIsNearest) {
  const StereoRig rig = LocCamRig();
  std::vector<Feature> features;
  for (int i = 0; i < 100; ++i) features.push_back(Seen(rig, {0.1, 0.1, 1.0 + 0.1 * i}));
  Feature lone = features.front();
  lone.right.reset();
  features.insert(features.end(), 500, lone);
  ASSERT_TRUE(NearDepth(features, rig));
  EXPECT_NEAR(*NearDepth(features, rig), 1.5, 0.1);
  features.erase(features.begin(), features.begin() + 81);
  EXPECT_FALSE(NearDepth(features, rig));
}

TEST(TriangulateFeatures, SigmaIsWhatTheDisparityNoiseDoesAlongTheRay) {
  SeededRandom random;
  const StereoRig rig = LocCamRig();
  constexpr double kNoise_px = 0.05;
  for (int i = 0; i < 200; ++i) {
    // Near the axis, where the distortion does not change the focal length.
    const double z_m = random.Uniform(1.0, 8.0);
    const Eigen::Vector3d x(z_m * random.Uniform(-0.1, 0.1), z_m * random.Uniform(-0.1, 0.1), z_m);
    Feature off = Seen(rig, x);
    off.right->x() += kNoise_px;
    const auto point = TriangulateFeatures({off}, rig, kNoise_px).at(0);
    ASSERT_TRUE(point);
    const double moved_m = (point->x_in_left - x).dot(x.normalized());
    EXPECT_NEAR(moved_m, point->depth_sigma_m, 0.05 * point->depth_sigma_m) << x.transpose();
    EXPECT_NEAR(TriangulateFeatures({off}, rig, 2.0 * kNoise_px).at(0)->depth_sigma_m,
                2.0 * point->depth_sigma_m, 1e-9);
  }
}

TEST(TriangulateFeatures, GivesNothingWithoutAStereoMatchOrBehind) {
  const StereoRig rig = LocCamRig();
  const Feature good = Seen(rig, {0.1, 0.2, 3.0});
  Feature alone = good, crossed = good;
  alone.right.reset();
  crossed.right->x() += 200.0;  // the rays part
  const auto points = TriangulateFeatures({alone, good, crossed}, rig, 0.15);
  ASSERT_EQ(points.size(), 3u);
  EXPECT_FALSE(points[0]);
  EXPECT_TRUE(points[1]);
  EXPECT_FALSE(points[2]);
  EXPECT_TRUE(TriangulateFeatures({}, rig, 0.15).empty());
}

TEST(NormaliseFeatures, IsTheInverseOfProjecting) {
  SeededRandom random;
  const StereoRig rig = LocCamRig();
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d x = PointInView(random);
    const NormalisedFeature feature = NormaliseFeatures({Seen(rig, x)}, rig).at(0);
    ASSERT_TRUE(feature.left && feature.right);
    EXPECT_LT((*feature.left - x.hnormalized()).norm(), 1e-9);
    EXPECT_LT((*feature.right - (rig.right_from_left * x).hnormalized()).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace rigmap
