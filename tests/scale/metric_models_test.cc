#include "scale/metric_models.h"

#include <gmock/gmock.h>

#include <limits>

#include "scale/baseline_scale.h"
#include "tests/support/rover_correspondences.h"

namespace rigmap {
namespace {

// Two keyframes, at frames 1 and 3 of 4, whose model is half as large as the world. One point is
// seen by both left images and a right one, one by right images alone.
class MetricModels : public testing::Test {
 protected:
  MetricModels() : rig_(MakeSyntheticRover().rig) {
    const double half = 0.5 * rig_.Baseline();
    for (int k = 0; k < 2; ++k) AddKeyframe(k, half);
    model_.points.push_back(
        {.id = 1,
         .x_in_model = {0.1, 0.2, 3.0},
         .error_px = 0.25,
         .track = {{{0, Eye::kRight}, 0}, {{0, Eye::kLeft}, 0}, {{1, Eye::kLeft}, 1}}});
    model_.points.push_back({.id = 2,
                             .x_in_model = {0.0, 0.0, 2.0},
                             .error_px = 0.75,
                             .track = {{{0, Eye::kRight}, 1}, {{1, Eye::kRight}, 1}}});
  }

  void AddKeyframe(int k, double baseline_in_model) {
    for (const Eye eye : kEyes) {
      SparseImage image{.ref = {k, eye}};
      const Eigen::Vector3d centre(eye == Eye::kLeft ? 0.0 : baseline_in_model, 0.0, 0.5 * k);
      image.camera_from_model.translation = -centre;
      image.keypoints = {{{10.0 + k, 20.0}, {}}, {{30.0, 40.0 + k}, {}}};
      model_.images.push_back(image);
    }
  }

  Adjustment InMetresOf(const std::vector<SparseModel>& models,
                        const std::vector<int>& frames = {1, 3}) const {
    const std::vector<Rigid3> odometric(frames.size());
    const AlignedKeyframes aligned =
        AlignModels(models, MeasureBaselines(models, rig_.Baseline(), {}), odometric);
    return InMetres(models, aligned, frames, frames.back() + 1, rig_);
  }

  StereoRig rig_;
  SparseModel model_;
};

TEST_F(MetricModels, HaveTheLengthsOfTheRig) {
  const Adjustment metric = InMetresOf({model_});
  ASSERT_EQ(metric.world_from_left.size(), 4U);
  EXPECT_FALSE(metric.world_from_left[0] || metric.world_from_left[2]);
  ASSERT_TRUE(metric.world_from_left[1] && metric.world_from_left[3]);
  const Eigen::Vector3d step =
      metric.world_from_left[3]->translation - metric.world_from_left[1]->translation;
  EXPECT_NEAR(step.norm(), 1.0, 1e-9);
  EXPECT_EQ(metric.datum_frames, (std::vector{0, 1, 2, 1}));
  EXPECT_TRUE(metric.covariances.empty());
  // Of two pairs nobody knows how far they spread.
  EXPECT_EQ(metric.scale_sigma, std::numeric_limits<double>::infinity());
}

TEST_F(MetricModels, KeepThePointsThatALeftImageShowsWithThoseFirst) {
  const Adjustment metric = InMetresOf({model_});
  ASSERT_EQ(metric.points.size(), 1U);
  const AdjustedPoint& point = metric.points.front();
  EXPECT_LT(
      (metric.world_from_left[1]->Inverse() * point.x - Eigen::Vector3d(0.2, 0.4, 6.0)).norm(),
      1e-9);
  ASSERT_EQ(point.observations.size(), 3U);
  EXPECT_EQ(point.observations[0].eye, Eye::kLeft);
  EXPECT_EQ(point.observations[0].frame, 1);
  EXPECT_EQ(point.observations[1].frame, 3);
  EXPECT_EQ(point.observations[1].pixel, Eigen::Vector2d(30.0, 41.0));
  EXPECT_EQ(point.observations[2].eye, Eye::kRight);
  EXPECT_NEAR(metric.reprojection_px, 0.25, 1e-12);
}

TEST_F(MetricModels, SayHowFarTheDistancesSpread) {
  model_.images[3].camera_from_model.translation.x() *= 1.02;
  AddKeyframe(2, 0.98 * 0.5 * rig_.Baseline());
  const Adjustment metric = InMetresOf({model_}, {1, 3, 4});
  ASSERT_TRUE(metric.scale_sigma);
  EXPECT_NEAR(*metric.scale_sigma, 1.4826 * 0.02, 1e-6);
}

TEST_F(MetricModels, AreNothingWithoutModels) {
  const Adjustment metric = InMetresOf({});
  EXPECT_TRUE(metric.points.empty());
  EXPECT_FALSE(metric.scale_sigma);
  for (const auto& pose : metric.world_from_left) EXPECT_FALSE(pose);
}

}  // namespace
}  // namespace rigmap
