#include "features/rig_fixed.h"

#include <gtest/gtest.h>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

constexpr int kWidth = 640, kHeight = 480;

// Frames of a rover that drives over ground: features move down the image by `step_px`, those of a
// wheel in the lower left corner rest, and so do those far away at the top.
class RigFixedTest : public testing::Test {
 protected:
  RigFixedTest() {
    for (int i = 0; i < 300; ++i) {
      Add({random_.Uniform(5, 630), random_.Uniform(200, 420)}, 20.0, true);  // ground
      if (i % 5 == 0) {
        Add({random_.Uniform(2, 60), random_.Uniform(430, 475)}, 40.0, false);  // wheel
        Add({random_.Uniform(5, 630), random_.Uniform(20, 90)}, 0.5, false);    // horizon
      }
    }
  }

  void Add(const Eigen::Vector2d& pixel, double disparity_px, bool moves) {
    Feature feature{.left = pixel};
    feature.right = pixel - Eigen::Vector2d(disparity_px, 0.0);
    first_.features.push_back(feature);
    Descriptor descriptor;
    for (auto& value : descriptor) value = static_cast<std::uint8_t>(random_.Uniform(0.0, 90.0));
    first_.descriptors.push_back(descriptor);
    first_.patches.push_back({});
    moves_.push_back(moves);
  }

  FrameFeatures After(double moved_px) {
    FrameFeatures frame = first_;
    for (std::size_t i = 0; i < moves_.size(); ++i) {
      const double noise_px = random_.Uniform(-0.3, 0.3);
      const double shift_px = moves_[i] ? moved_px + noise_px : noise_px;
      frame.features[i].left.y() += shift_px;
      frame.features[i].right->y() += shift_px;
    }
    return frame;
  }

  RigFixedCells Watch(double step_px) {
    RigFixedVotes votes(kWidth, kHeight);
    for (int i = 0; i < 6; ++i) votes.Compare(After(i * step_px), After((i + 1) * step_px));
    return votes.Decide();
  }

  SeededRandom random_;
  FrameFeatures first_;
  std::vector<bool> moves_;
};

TEST_F(RigFixedTest, TheWheelIsFoundTheHorizonIsNot) {
  const RigFixedCells cells = Watch(8.0);
  FrameFeatures left = first_;
  cells.RemoveFrom(left);
  ASSERT_EQ(left.features.size(), left.descriptors.size());
  ASSERT_EQ(left.features.size(), left.patches.size());
  const auto count = [](const FrameFeatures& frame, double top, double bottom) {
    return std::ranges::count_if(
        frame.features, [&](const Feature& f) { return f.left.y() >= top && f.left.y() < bottom; });
  };
  EXPECT_EQ(count(left, 0, 425), count(first_, 0, 425));
  EXPECT_LT(count(left, 430, 480), 0.2 * static_cast<double>(count(first_, 430, 480)));
  // Each descriptor stays with its feature.
  for (std::size_t i = 0; i < left.features.size(); ++i) {
    const auto at = std::ranges::find_if(
        first_.features, [&](const Feature& f) { return f.left == left.features[i].left; });
    ASSERT_NE(at, first_.features.end());
    EXPECT_EQ(left.descriptors[i], first_.descriptors[at - first_.features.begin()]);
  }
}

TEST_F(RigFixedTest, WhileTheRoverStandsNothingIsFixed) {
  const RigFixedCells cells = Watch(0.0);
  for (const Feature& feature : first_.features) EXPECT_FALSE(cells.Cover(feature.left));
}

TEST_F(RigFixedTest, WithoutVotesNothingIsCovered) {
  EXPECT_FALSE(RigFixedCells().Cover({10.0, 10.0}));
  FrameFeatures same = first_;
  RigFixedVotes(kWidth, kHeight).Decide().RemoveFrom(same);
  EXPECT_EQ(same.features.size(), first_.features.size());
}

TEST(RigFixedCells, MaskIsZeroWhereTheyCover) {
  const RigFixedCells cells{8, 3, {0, 1, 0, 0, 0, 1}};
  const cv::Mat mask = cells.Mask(22, 15);  // the last column and row of cells are cut off
  ASSERT_EQ(mask.size(), cv::Size(22, 15));
  for (int row = 0; row < mask.rows; ++row) {
    for (int column = 0; column < mask.cols; ++column) {
      EXPECT_EQ(mask.at<uchar>(row, column) == 0, cells.Cover({column, row}));
    }
  }
  EXPECT_EQ(cv::countNonZero(RigFixedCells().Mask(5, 4)), 20);
}

}  // namespace
}  // namespace rigmap
