#include "fusion/internal/carried_cells.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/fusion/seen_ground.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

const cv::Rect kWheel(40, 176, 48, 56);

// 24 frames 0.17 m apart over flat ground.
class CarriedOverGround : public testing::Test {
 protected:
  // In some of the frames something stands at the same pixels, at two thirds of the ground's depth.
  cv::Mat CarriedWhere(const std::vector<int>& frames_with_wheel) {
    std::vector<PosedDepth> depths;
    std::vector<Rigid3> poses;
    SeededRandom random;
    for (int i = 0; i < kFrames; ++i) {
      poses.push_back(WorldFromLeft(0.17 * i));
      DepthMap map = GroundSeenFrom(poses.back(), {.noise_px = 0.1}, random);
      if (std::ranges::count(frames_with_wheel, i) > 0) map.disparity(kWheel) *= 1.5;
      depths.push_back({folder_.Path() / std::to_string(i), "key", poses.back()});
      SaveDepth(depths.back().path, "key", map);
    }
    ViewCache views(depths, 10);
    return CarriedByTheRig(poses, {}, views);
  }

  static constexpr int kFrames = 24;
  TemporaryFolder folder_;
};

TEST_F(CarriedOverGround, NothingIsHidden) { EXPECT_TRUE(CarriedWhere({}).empty()); }

TEST_F(CarriedOverGround, AWheelInTheViewIsHiddenAndLittleBesideIt) {
  std::vector<int> all;
  for (int i = 0; i < kFrames; ++i) all.push_back(i);
  const cv::Mat mask = CarriedWhere(all);
  ASSERT_EQ(mask.size(), cv::Size(320, 240));
  EXPECT_EQ(cv::countNonZero(mask(kWheel)), kWheel.area());
  cv::Mat beside = mask.clone();
  constexpr int kMargin_px = 8;
  beside(cv::Rect(kWheel.tl() - cv::Point(kMargin_px, kMargin_px),
                  kWheel.br() + cv::Point(kMargin_px, kMargin_px)) &
         cv::Rect(0, 0, 320, 240)) = 0;
  EXPECT_EQ(cv::countNonZero(beside), 0);
}

TEST_F(CarriedOverGround, WhoStandsThereForAMomentIsNoPartOfTheRig) {
  EXPECT_TRUE(CarriedWhere({9, 10, 11, 12}).empty());
}

}  // namespace
}  // namespace rigmap
