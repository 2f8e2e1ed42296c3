#include "fusion/internal/view_consistency.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "tests/fusion/seen_ground.h"

namespace rigmap {
namespace {

DepthView ViewOf(const Rigid3& world_from_left, const GroundView& ground_view,
                 SeededRandom& random) {
  DepthMap map = GroundSeenFrom(world_from_left, ground_view, random);
  const Rigid3 world_from_rectified = world_from_left * map.left_from_rectified;
  return {std::move(map), world_from_rectified};
}

DepthView ViewFrom(double x_m, const GroundView& ground_view, SeededRandom& random) {
  return ViewOf(WorldFromLeft(x_m), ground_view, random);
}

// Whether `view` knows a depth where it sees the point.
bool Knows(const DepthView& view, const Eigen::Vector3d& x_in_rectified) {
  const auto pixel = Project(view.map.camera, x_in_rectified);
  return pixel && view.map.camera.Contains(*pixel) &&
         view.map.disparity.at<float>(static_cast<int>(std::lround(pixel->y())),
                                      static_cast<int>(std::lround(pixel->x()))) > 0.0F;
}

// How many samples lie clearly above the ground.
int CountRaised(const std::vector<SurfaceSample>& samples) {
  int raised = 0;
  for (const SurfaceSample& sample : samples) raised += sample.x_in_world.z() > 0.2;
  return raised;
}

class ViewConsistency : public testing::Test {
 protected:
  // Of the view from the start of the path with another.
  ViewAgreement AgreementWith(const DepthView& second) {
    return AgreementOf(ViewFrom(0.0, ground_view_, random_), second, options_).value();
  }

  SeededRandom random_;
  FusionOptions options_;
  GroundView ground_view_{.noise_px = 0.05, .sigma_px = 0.1, .plate = {}};
  GroundView plate_view_{
      .noise_px = 0.05, .sigma_px = 0.1, .plate = Plate{{2.9, -0.3}, {3.3, 0.3}, 0.3}};
};

TEST_F(ViewConsistency, NeedsEnoughViews) {
  const DepthView reference = ViewFrom(0.0, ground_view_, random_);
  const DepthView near = ViewFrom(0.1, ground_view_, random_);
  EXPECT_TRUE(ConfirmedSamples(reference, {}, options_).empty());
  EXPECT_GT(ConfirmedSamples(reference, {{&near}, {}}, options_).size(), 30000U);
  options_.min_views = 1;
  // All but some in corners, whose surface cannot be told.
  EXPECT_GT(ConfirmedSamples(reference, {}, options_).size(),
            0.9995 * cv::countNonZero(reference.map.disparity));
}

TEST_F(ViewConsistency, IsDeniedByOneFrameAheadHoweverManyNearOnesAgree) {
  const DepthView reference = ViewFrom(0.0, plate_view_, random_);
  const DepthView one = ViewFrom(0.05, plate_view_, random_);
  const DepthView two = ViewFrom(0.1, plate_view_, random_);
  const DepthView ahead = ViewFrom(0.6, ground_view_, random_);
  EXPECT_GT(CountRaised(ConfirmedSamples(reference, {{&one, &two}, {}}, options_)), 300);
  EXPECT_EQ(CountRaised(ConfirmedSamples(reference, {{&one, &two}, {&ahead}}, options_)), 0);
}

TEST_F(ViewConsistency, IsNotDeniedByAFrameFromNoNearer) {
  const DepthView reference = ViewFrom(0.0, plate_view_, random_);
  const DepthView one = ViewFrom(0.05, plate_view_, random_);
  const DepthView beside = ViewFrom(0.02, ground_view_, random_);
  EXPECT_GT(CountRaised(ConfirmedSamples(reference, {{&one}, {&beside}}, options_)), 300);
}

// Two frames agree on something; of the others, in whose images it would be, none sees through it,
// but four know no depth there: it walked by before the sky.
TEST_F(ViewConsistency, LeavesOutWhatTwoSeeWhereFourKnowNoDepth) {
  const DepthView reference = ViewFrom(0.0, plate_view_, random_);
  const DepthView agreeing = ViewFrom(0.05, plate_view_, random_);
  DepthView empty = ViewFrom(0.02, plate_view_, random_);
  empty.map.disparity.setTo(0.0F);
  const auto count = [&](int without_depth) {
    std::vector<const DepthView*> near(static_cast<std::size_t>(without_depth), &empty);
    near.push_back(&agreeing);
    return CountRaised(ConfirmedSamples(reference, {near, {}}, options_));
  };
  EXPECT_GT(count(3), 300);
  EXPECT_EQ(count(4), 0);
}

TEST_F(ViewConsistency, LeavesPointsToANearerFrameAhead) {
  const DepthView reference = ViewFrom(0.0, ground_view_, random_);
  const DepthView near = ViewFrom(0.1, ground_view_, random_);
  const DepthView ahead = ViewFrom(1.0, ground_view_, random_);
  const std::size_t alone = ConfirmedSamples(reference, {{&near}, {}}, options_).size();
  const auto kept = ConfirmedSamples(reference, {{&near}, {&ahead}}, options_);
  EXPECT_LT(kept.size(), alone);
  ASSERT_GT(kept.size(), alone / 4);  // at its feet, where the other does not look
  std::size_t seen_nearer = 0;
  for (const SurfaceSample& sample : kept) {
    const Eigen::Vector3d x = ahead.world_from_rectified.Inverse() * sample.x_in_world;
    const double own_m = (reference.world_from_rectified.Inverse() * sample.x_in_world).z();
    seen_nearer += Knows(ahead, x) && x.z() * x.z() < options_.better_view_share * own_m * own_m;
  }
  EXPECT_LT(seen_nearer, kept.size() / 50);  // at the ahead frame's margins, by rounding to pixels
}

TEST_F(ViewConsistency, TellsHowFlatlyGroundIsSeen) {
  options_.min_views = 1;
  const DepthView view = ViewFrom(0.0, ground_view_, random_);
  int count = 0;
  double flattest = 1.0;
  for (const SurfaceSample& sample : ConfirmedSamples(view, {}, options_)) {
    const Eigen::Vector3d ray = sample.x_in_world - view.world_from_rectified.translation;
    ASSERT_NEAR(sample.cosine, -sample.normal.cast<double>().dot(ray.normalized()), 1e-5);
    flattest = std::min<double>(flattest, sample.cosine);
    ++count;
  }
  EXPECT_GT(count, 30000);
  EXPECT_LT(flattest, 0.3);
}

TEST_F(ViewConsistency, LeavesOutTheSlopeBetweenTwoDepths) {
  // As matchers leave it at the edge of something that stands before the ground.
  const cv::Rect slope(200, 50, 16, 28), inner(204, 54, 8, 20);
  DepthView view = ViewFrom(0.0, ground_view_, random_);
  for (int row = slope.y; row < slope.br().y; ++row) {
    auto* disparity = view.map.disparity.ptr<float>(row);
    for (int i = 0; i < slope.width; ++i) {
      disparity[slope.x + i] = disparity[slope.x - 1] + 0.5F * static_cast<float>(i + 1);
    }
  }
  const auto count_inside = [&](double max_incidence_deg) {
    options_.max_incidence_deg = max_incidence_deg;
    int count = 0;
    for (const SurfaceSample& sample : ConfirmedSamples(view, {{&view}, {}}, options_)) {
      const auto pixel =
          Project(view.map.camera, view.world_from_rectified.Inverse() * sample.x_in_world);
      count += inner.contains({cvRound(pixel->x()), cvRound(pixel->y())});
    }
    return count;
  };
  EXPECT_GT(count_inside(90.0), inner.area() / 2);
  EXPECT_EQ(count_inside(FusionOptions().max_incidence_deg), 0);
}

TEST_F(ViewConsistency, AgreesWithItself) {
  const DepthView view = ViewFrom(0.0, ground_view_, random_);
  const auto agreement = AgreementOf(view, view, options_);
  ASSERT_TRUE(agreement);
  EXPECT_EQ(agreement->share, 1.0);
  EXPECT_EQ(agreement->brightness, 1.0);
}

TEST_F(ViewConsistency, AgreesWithASoundNeighbour) {
  EXPECT_GT(AgreementWith(ViewFrom(0.3, ground_view_, random_)).share, 0.99);
}

TEST_F(ViewConsistency, DisagreesWithShiftedDepth) {
  DepthView shifted = ViewFrom(0.0, ground_view_, random_);
  shifted.map.disparity *= 1.2;
  EXPECT_LT(AgreementWith(shifted).share, 0.01);
}

TEST_F(ViewConsistency, TellsHowMuchBrighterTheSecondViewIs) {
  DepthView brighter = ViewFrom(0.1, ground_view_, random_);
  brighter.map.colour *= 2.0;
  EXPECT_NEAR(AgreementWith(brighter).brightness, 2.0, 1e-9);
  const DepthView view = ViewFrom(0.0, ground_view_, random_);
  EXPECT_NEAR(AgreementOf(brighter, view, options_)->brightness, 0.5, 1e-9);
}

TEST_F(ViewConsistency, SaysNothingOfFramesThatShareNoView) {
  const DepthView view = ViewFrom(0.0, ground_view_, random_);
  Rigid3 turned = WorldFromLeft(0.0);
  turned.rotation = ExpRotation({0.0, 0.0, std::numbers::pi}) * turned.rotation;
  EXPECT_FALSE(AgreementOf(view, ViewOf(turned, ground_view_, random_), options_));
}

TEST_F(ViewConsistency, SaysNothingOfTooFewSharedPixels) {
  const DepthView view = ViewFrom(0.0, ground_view_, random_);
  const auto agreement_of = [&](int rows) {  // of ten asked pixels each
    DepthView part = view;
    part.map.disparity = cv::Mat(view.map.disparity.size(), CV_32FC1, cv::Scalar(0.0));
    const cv::Rect known(80, 80, 80, 8 * rows);
    view.map.disparity(known).copyTo(part.map.disparity(known));
    return AgreementOf(part, view, options_);
  };
  ASSERT_TRUE(agreement_of(kMinSharedPixels / 10));
  EXPECT_EQ(agreement_of(kMinSharedPixels / 10)->share, 1.0);
  EXPECT_FALSE(agreement_of(kMinSharedPixels / 10 - 1));
}

}  // namespace
}  // namespace rigmap
