#include "odometry/lone_views.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

constexpr double kLoneViewSigma_px = 0.1;

// Three frames of a drive, of which the second has one eye only.
class LoneViewsTest : public testing::Test {
 protected:
  void Make(unsigned seed = 1) {
    rover_ = MakeSyntheticRover({.frames = 3,
                                 .step_m = 0.6,
                                 .curve_rad_per_m = 0.2,
                                 .pixel_sigma = kLoneViewSigma_px,
                                 .seed = seed});
    frames_ = {rover_.frames[0], rover_.frames[2]};
    odometry_.clear();
    for (const FrameFeatures& frame : frames_) odometry_.push_back({.stamp_ns = frame.stamp_ns});
    odometry_[0].source = PoseSource::kOdometry;
    odometry_[0].keyframe = odometry_[1].keyframe = true;
    odometry_[1].world_from_left.translation.z() = 0.5;  // guessed
  }

  LoneView View(Eye eye) const {
    LoneView view{eye, {.stamp_ns = rover_.frames[1].stamp_ns}};
    for (std::size_t i = 0; i < rover_.frames[1].features.size(); ++i) {
      const Feature& feature = rover_.frames[1].features[i];
      if (eye == Eye::kRight && !feature.right) continue;
      view.features.features.push_back(
          {.left = eye == Eye::kLeft ? feature.left : Eigen::Vector2d(*feature.right)});
      view.features.descriptors.push_back(rover_.frames[1].descriptors[i]);
    }
    return view;
  }

  // Nothing is asked for but what lies between the two.
  Odometry Bridge(const std::vector<LoneView>& views) const {
    const auto between = [&](StampNs after, StampNs before) {
      std::vector<LoneView> found;
      for (const LoneView& view : views) {
        if (after < view.features.stamp_ns && view.features.stamp_ns < before)
          found.push_back(view);
      }
      return found;
    };
    return BridgeByLoneViews(
        odometry_, [&](int frame) { return frames_[frame]; }, between, rover_.rig, options_);
  }

  // The second frame's error, of a perturbation of its motion.
  Vector6d ErrorOf(const Odometry& bridged, int frame, int true_frame) const {
    const Rigid3 found = bridged[frame].world_from_left.Inverse();  // world: the first frame
    const Rigid3 error =
        found * rover_.world_from_left[0].Inverse() * rover_.world_from_left[true_frame];
    Vector6d perturbation;
    perturbation << error.translation, LogRotation(error.rotation);
    return perturbation;
  }

  SyntheticRover rover_;
  std::vector<FrameFeatures> frames_;
  Odometry odometry_;
  OdometryOptions options_;
};

TEST_F(LoneViewsTest, OneEyeInBetweenTiesTwoFramesThatNothingElseDoes) {
  Make();
  for (const Eye eye : kEyes) {
    const Odometry bridged = Bridge({View(eye)});
    EXPECT_EQ(bridged[1].source, PoseSource::kOdometry);
    EXPECT_EQ(bridged[1].reference, 0);
    EXPECT_GE(bridged[1].inliers, options_.min_inliers);
    const Vector6d error = ErrorOf(bridged, 1, 2);
    EXPECT_LT(error.head<3>().norm(), 0.01) << "of 1.2 m";
    EXPECT_LT(error.tail<3>().norm(), 0.003);
  }
}

TEST_F(LoneViewsTest, ItsCovarianceIsAboutTheError) {
  options_.keypoint_noise_px = kLoneViewSigma_px * std::sqrt(2.0);
  options_.disparity_noise_px = kLoneViewSigma_px * std::sqrt(2.0);
  options_.shared_noise = 1.0;
  double sum = 0.0;
  constexpr int kTrials = 40;
  for (unsigned seed = 1; seed <= kTrials; ++seed) {
    Make(seed);
    const Odometry bridged = Bridge({View(seed % 2 == 0 ? Eye::kLeft : Eye::kRight)});
    ASSERT_EQ(bridged[1].source, PoseSource::kOdometry);
    const Vector6d error = ErrorOf(bridged, 1, 2);
    sum += error.dot(bridged[1].step_covariance.ldlt().solve(error));
  }
  EXPECT_NEAR(sum / kTrials, 6.0, 0.3 * 6.0);
}

TEST_F(LoneViewsTest, AFrameWithOneReadableImageIsPosedByIt) {
  Make();
  // The second frame's other image is damaged, and nothing follows.
  frames_[1] = {.stamp_ns = rover_.frames[1].stamp_ns, .unreadable_images = {"left.png"}};
  odometry_[1].stamp_ns = frames_[1].stamp_ns;
  odometry_[1].keyframe = false;
  const Odometry bridged = Bridge({View(Eye::kRight)});
  EXPECT_EQ(bridged[1].source, PoseSource::kOdometry);
  EXPECT_LT(ErrorOf(bridged, 1, 1).head<3>().norm(), 0.005);
}

// Between both stereo frames lies one that shows nothing, posed by a guess that goes astray.
TEST_F(LoneViewsTest, AGuessInBetweenIsMovedOntoTheWay) {
  Make();
  const FrameFeatures nothing{.stamp_ns = (frames_[0].stamp_ns + frames_[1].stamp_ns) / 2 + 1000};
  frames_.insert(frames_.begin() + 1, nothing);
  OdometryFrame guess{.stamp_ns = nothing.stamp_ns};
  guess.world_from_left.translation = {0.3, 0.2, 0.1};
  odometry_.insert(odometry_.begin() + 1, guess);
  odometry_[2].reference = 1;
  const Odometry bridged = Bridge({View(Eye::kLeft)});
  ASSERT_EQ(bridged[2].source, PoseSource::kOdometry);
  EXPECT_EQ(bridged[1].source, PoseSource::kPredicted);
  const Eigen::Vector3d half_way = 0.5 * bridged[2].world_from_left.translation;
  EXPECT_LT((bridged[1].world_from_left.translation - half_way).norm(), 0.05);
}

// Of ground ten times as far away the disparity tells no metres, whatever it was measured to.
TEST_F(LoneViewsTest, FarGroundTellsNoMetres) {
  Make();
  const double near_m2 =
      Bridge({View(Eye::kLeft)})[1].step_covariance.topLeftCorner<3, 3>().trace();
  options_.disparity_noise_px *= 38.0;  // hardly a depth is known to a tenth, most to a third
  const Odometry bridged = Bridge({View(Eye::kLeft)});
  ASSERT_EQ(bridged[1].source, PoseSource::kOdometry);
  const double far_m2 = bridged[1].step_covariance.topLeftCorner<3, 3>().trace();
  EXPECT_GT(std::sqrt(far_m2), 0.1 * 0.6) << "a tenth of the shorter way";
  EXPECT_LT(near_m2, 0.1 * far_m2);
  options_.disparity_noise_px *= 10.0;
  EXPECT_EQ(Bridge({View(Eye::kLeft)})[1].source, PoseSource::kPredicted);
}

TEST_F(LoneViewsTest, AnImageOfSomethingElseTiesNothing) {
  Make();
  LoneView other = View(Eye::kLeft);
  for (Descriptor& descriptor : other.features.descriptors) {
    std::ranges::reverse(descriptor);
  }
  for (const Odometry& bridged : {Bridge({other}), Bridge({})}) {
    EXPECT_EQ(bridged[1].source, PoseSource::kPredicted);
    EXPECT_EQ(bridged[1].world_from_left.translation, odometry_[1].world_from_left.translation);
  }
}

TEST_F(LoneViewsTest, WhatWasNotLostIsNotAskedAbout) {
  Make();
  odometry_[1].source = PoseSource::kOdometry;
  const auto fail = [](StampNs, StampNs) -> std::vector<LoneView> {
    ADD_FAILURE() << "asked";
    return {};
  };
  const Odometry same = BridgeByLoneViews(
      odometry_, [&](int frame) { return frames_[frame]; }, fail, rover_.rig, options_);
  EXPECT_EQ(same[1].world_from_left.translation, odometry_[1].world_from_left.translation);
}

}  // namespace
}  // namespace rigmap
