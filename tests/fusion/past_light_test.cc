#include "fusion/internal/past_light.h"

#include <gtest/gtest.h>

#include "tests/fusion/seen_ground.h"

namespace rigmap {
namespace {

constexpr int kLit = 120, kShaded = 40;

// Frames 0.1 m apart over ground that is grey throughout.
class PastLightOverGround : public testing::Test {
 protected:
  DepthView ViewOf(int frame) {
    const Rigid3 world_from_left = WorldFromLeft(0.1 * frame);
    DepthMap map = GroundSeenFrom(world_from_left, {}, random_);
    map.colour = cv::Scalar::all(kLit);
    const Rigid3 world_from_rectified = world_from_left * map.left_from_rectified;
    return {std::move(map), world_from_rectified};
  }
  // The rover's shadow, which lies in the same rows and columns of each image.
  static cv::Mat ShadowIn(DepthView& view) { return view.map.colour(cv::Rect(100, 170, 120, 70)); }
  // Nothing is lit where frames see what `change` makes of their views.
  template <class Change>
  void ExpectNoneLit(int frames, const Change& change) {
    for (int frame = 0; frame <= frames; ++frame) {
      DepthView view = ViewOf(frame);
      change(view);
      const cv::Mat lit = past_light_.Lit(view, 1.0);
      EXPECT_EQ(cv::norm(lit, view.map.colour, cv::NORM_INF), 0.0) << frame;
    }
  }
  static int GreyAt(const cv::Mat& image, int column, int row) {
    return image.at<cv::Vec3b>(row, column)[1];
  }

  SeededRandom random_;
  PastLight past_light_;
};

TEST_F(PastLightOverGround, TakesTheRoversShadowAway) {
  DepthView view;
  for (int frame = 0; frame < 30; ++frame) {
    view = ViewOf(frame);
    ShadowIn(view) = cv::Scalar::all(kShaded);
    past_light_.Lit(view, 1.0);
  }
  view = ViewOf(30);
  ShadowIn(view) = cv::Scalar::all(kShaded);
  const cv::Mat lit = past_light_.Lit(view, 1.0);
  for (const int row : {180, 200, 215}) EXPECT_NEAR(GreyAt(lit, 160, row), kLit, 3) << row;
  EXPECT_EQ(GreyAt(lit, 40, 180), kLit);
  EXPECT_EQ(GreyAt(view.map.colour, 160, 200), kShaded);  // which is of the cache
}

TEST_F(PastLightOverGround, TakesAThinShadowAwayThatHangsTogetherWithAWideOne) {
  const cv::Rect mast(156, 140, 6, 40), stick(60, 140, 6, 40);  // that begins where the body ends
  const auto darken = [&](DepthView& view) {
    ShadowIn(view) = cv::Scalar::all(kShaded);
    for (const cv::Rect& thin : {mast, stick}) view.map.colour(thin) = cv::Scalar::all(kShaded);
  };
  for (int frame = 0; frame < 30; ++frame) {
    DepthView view = ViewOf(frame);
    darken(view);
    past_light_.Lit(view, 1.0);
  }
  DepthView view = ViewOf(30);
  darken(view);
  const cv::Mat lit = past_light_.Lit(view, 1.0);
  for (const int row : {150, 160, 170}) {
    EXPECT_NEAR(GreyAt(lit, 159, row), kLit, 8) << row;
    EXPECT_EQ(GreyAt(lit, 63, row), kShaded) << row;
  }
}

TEST_F(PastLightOverGround, KeepsThePatternOfTheGround) {
  for (int frame = 0; frame < 30; ++frame) past_light_.Lit(ViewOf(frame), 1.0);
  DepthView view = ViewOf(30);
  ShadowIn(view) = cv::Scalar::all(kShaded);
  cv::Mat stones = view.map.colour(cv::Rect(150, 190, 1, 20));
  stones = cv::Scalar::all(kShaded / 2);
  const cv::Mat lit = past_light_.Lit(view, 1.0);
  EXPECT_LT(GreyAt(lit, 150, 200), 0.7 * GreyAt(lit, 154, 200));
}

TEST_F(PastLightOverGround, LeavesWhatWasDarkAllAlong) {
  const auto darken = [](DepthView& view) {  // beyond 4 m of the way
    for (int row = 0; row < 240; ++row) {
      for (int column = 0; column < 320; ++column) {
        const float disparity_px = view.map.disparity.at<float>(row, column);
        if (disparity_px <= 0.0F) continue;
        const Eigen::Vector3d x =
            view.world_from_rectified * view.map.PointInRectified(column, row, disparity_px);
        if (x.x() > 4.0) view.map.colour.at<cv::Vec3b>(row, column) = cv::Vec3b::all(kShaded);
      }
    }
  };
  ExpectNoneLit(30, darken);
}

TEST_F(PastLightOverGround, LeavesWhatGrowsDarkerByAndByTowardsTheEdgeOfTheImage) {
  const auto shade_edges = [](DepthView& view) {
    for (int row = 120; row < 240; ++row) {
      view.map.colour.row(row) = cv::Scalar::all(kLit - 0.4 * kLit * (row - 120) / 120.0);
    }
  };
  ExpectNoneLit(60, shade_edges);
}

TEST_F(PastLightOverGround, LeavesWhatIsDarkByItselfAndSeemsLighterFromAfar) {
  constexpr int kDark = 20, kVeiled = 35;
  for (int frame = 0; frame < 30; ++frame) {
    DepthView view = ViewOf(frame);
    view.map.colour = cv::Scalar::all(kVeiled);
    past_light_.Lit(view, 1.0);
  }
  DepthView view = ViewOf(30);
  ShadowIn(view) = cv::Scalar::all(kDark);
  const cv::Mat lit = past_light_.Lit(view, 1.0);
  EXPECT_EQ(GreyAt(lit, 160, 200), kDark);
}

TEST_F(PastLightOverGround, TakesABrighterExposureForNoLight) {
  for (int frame = 0; frame < 30; ++frame) past_light_.Lit(ViewOf(frame), 1.0);
  DepthView view = ViewOf(30);
  view.map.colour = cv::Scalar::all(kLit / 2);
  const cv::Mat lit = past_light_.Lit(view, 2.0);
  EXPECT_EQ(cv::norm(lit, view.map.colour, cv::NORM_INF), 0.0);
}

TEST_F(PastLightOverGround, NeedsFourThatSawTheGround) {
  const auto shaded_after = [&](int frames) {
    PastLight past_light;
    for (int frame = 0; frame < frames; ++frame) past_light.Lit(ViewOf(frame), 1.0);
    DepthView view = ViewOf(frames);
    ShadowIn(view) = cv::Scalar::all(kShaded);
    return GreyAt(past_light.Lit(view, 1.0), 160, 200);
  };
  EXPECT_EQ(shaded_after(9), kShaded);  // of which every third is asked
  EXPECT_NEAR(shaded_after(10), kLit, 3);
}

TEST_F(PastLightOverGround, ALongStopForgetsNothing) {
  for (int frame = 0; frame < 30; ++frame) past_light_.Lit(ViewOf(frame), 1.0);
  DepthView view = ViewOf(30);
  ShadowIn(view) = cv::Scalar::all(kShaded);
  for (int i = 0; i < 100; ++i) past_light_.Lit(view, 1.0);
  EXPECT_NEAR(GreyAt(past_light_.Lit(view, 1.0), 160, 200), kLit, 3);
}

}  // namespace
}  // namespace rigmap
