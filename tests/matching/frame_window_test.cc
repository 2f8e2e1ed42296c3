#include "matching/frame_window.h"

#include <gtest/gtest.h>

#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

class FrameWindowTest : public testing::Test {
 protected:
  FrameWindowTest() {
    SyntheticRoverOptions options;
    options.frames = 6;
    rover_ = MakeSyntheticRover(options);
  }
  FrameWindow Window(std::size_t held) {
    const auto load = [this](int frame) {
      ++loads_;
      return rover_.frames[frame];
    };
    return FrameWindow(load, rover_.rig, 0.15, held);
  }

  SyntheticRover rover_;
  int loads_ = 0;
};

TEST_F(FrameWindowTest, LoadsAFrameOnceWhileItIsHeld) {
  FrameWindow window = Window(3);
  for (int frame : {0, 1, 2, 0, 1, 2}) window.At(frame);
  EXPECT_EQ(loads_, 3);
  window.At(3);  // 0 goes
  window.At(1);
  EXPECT_EQ(loads_, 4);
  window.At(0);
  EXPECT_EQ(loads_, 5);
}

TEST_F(FrameWindowTest, KeepsPositionsOfFramesThatWereLetGo) {
  FrameWindow window = Window(2);
  const Eigen::Vector2d moved =
      window.At(0).refinement.refined[4].left + Eigen::Vector2d(0.3, -0.2);
  window.At(0).refinement.refined[4].left = moved;
  window.At(0).refinement.aligned[4] = true;
  for (int frame : {1, 2, 3}) window.At(frame);
  const FeatureRefinement& again = window.At(0).refinement;
  EXPECT_EQ(again.refined[4].left, moved);
  EXPECT_TRUE(again.aligned[4]);
  EXPECT_FALSE(again.aligned[5]);
  // The reference patch is the frame's own patch, and the place in it is the refined one.
  const Eigen::Vector2d found = again.found.features[4].left;
  const Eigen::Vector2d rounded(std::round(found.x()), std::round(found.y()));
  EXPECT_LT((again.references[4].offset - (moved - rounded)).norm(), 1e-12);
}

TEST_F(FrameWindowTest, KeepsFeaturesThatWereCarriedThere) {
  FrameWindow window = Window(2);
  const std::size_t extracted = window.At(0).refinement.refined.size();
  FeatureRefinement carried = StartRefinement(rover_.frames[1]);
  carried.aligned[7] = true;
  EXPECT_EQ(TakeOver(carried, 7, window.At(0).refinement), extracted);
  const Eigen::Vector2d pixel = carried.refined[7].left;
  for (int frame : {1, 2, 3}) window.At(frame);
  const MatchedFrame& again = window.At(0);
  ASSERT_EQ(again.refinement.refined.size(), extracted + 1);
  EXPECT_EQ(again.refinement.refined[extracted].left, pixel);
  EXPECT_EQ(again.refinement.found.features.size(), extracted + 1);
  EXPECT_EQ(again.refinement.found.descriptors.size(), extracted);
  EXPECT_TRUE(again.refinement.aligned[extracted]);
  EXPECT_EQ(again.points.size(), extracted + 1);
  EXPECT_EQ(window.Finish(6)[0].size(), extracted + 1);
}

TEST_F(FrameWindowTest, FinishGivesAllFrames) {
  FrameWindow window = Window(2);
  window.At(1).refinement.refined[0].left.x() += 1.0;
  window.At(2);
  window.At(3);
  const auto features = window.Finish(6);
  ASSERT_EQ(features.size(), 6u);
  for (int frame = 0; frame < 6; ++frame) {
    ASSERT_EQ(features[frame].size(), rover_.frames[frame].features.size());
    const double shift = features[frame][0].left.x() - rover_.frames[frame].features[0].left.x();
    EXPECT_NEAR(shift, frame == 1 ? 1.0 : 0.0, 1e-9) << frame;
  }
}

}  // namespace
}  // namespace rigmap
