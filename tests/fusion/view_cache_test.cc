#include "fusion/internal/view_cache.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <vector>

#include "core/error.h"
#include "tests/fusion/seen_ground.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

class ViewCacheOfGround : public testing::Test {
 protected:
  void SetUp() override {
    SeededRandom random;
    for (int i = 0; i < 4; ++i) {
      const Rigid3 world_from_left = WorldFromLeft(0.5 * i);
      DepthMap map = GroundSeenFrom(world_from_left, {.noise_px = 0.1}, random);
      map.stamp_ns = i;
      depths_.push_back({folder_.Path() / std::to_string(i), "key", world_from_left});
      SaveDepth(depths_.back().path, "key", map);
    }
  }

  const DepthView& One(ViewCache& cache, std::size_t frame) {
    const std::size_t frames[] = {frame};
    return *cache.Get(frames).at(0);
  }
  void RemoveFile(std::size_t frame) { std::filesystem::remove(depths_[frame].path); }

  TemporaryFolder folder_;
  std::vector<PosedDepth> depths_;
};

TEST_F(ViewCacheOfGround, GivesWhatWasSavedWhereItWasTaken) {
  ViewCache cache(depths_, 2);
  const DepthView& view = One(cache, 3);
  const DepthMap saved = *LoadDepth(depths_[3].path, "key");
  EXPECT_EQ(cv::norm(view.map.disparity, saved.disparity, cv::NORM_INF), 0.0);
  const Eigen::Vector3d x(0.1, 0.2, 2.0);
  EXPECT_LT(
      (view.world_from_rectified * x - depths_[3].world_from_left * (saved.left_from_rectified * x))
          .norm(),
      1e-12);
}

TEST_F(ViewCacheOfGround, GivesTheSameAgainAfterEviction) {
  ViewCache cache(depths_, 2);
  const DepthView first = One(cache, 0);
  const cv::Mat disparity = first.map.disparity.clone();
  const std::size_t others[] = {1, 2};
  cache.Get(others);
  const DepthView& again = One(cache, 0);
  EXPECT_EQ(again.map.stamp_ns, 0);
  EXPECT_NE(again.map.disparity.data, first.map.disparity.data) << "read anew";
  EXPECT_EQ(cv::norm(again.map.disparity, disparity, cv::NORM_INF), 0.0);
  EXPECT_EQ(again.world_from_rectified.translation, first.world_from_rectified.translation);
}

TEST_F(ViewCacheOfGround, KeepsThoseUsedLast) {
  ViewCache cache(depths_, 2);
  One(cache, 0);
  One(cache, 1);
  One(cache, 0);
  One(cache, 2);
  for (const std::size_t frame : {0, 1, 2}) RemoveFile(frame);
  EXPECT_EQ(One(cache, 0).map.stamp_ns, 0);
  EXPECT_EQ(One(cache, 2).map.stamp_ns, 2);
  EXPECT_THAT(MessageOf<DataError>([&] { One(cache, 1); }),
              testing::HasSubstr(depths_[1].path.string()));
}

TEST_F(ViewCacheOfGround, HidesInWhatItHoldsAndInWhatItReadsLater) {
  ViewCache cache(depths_, 2);
  One(cache, 0);
  cv::Mat mask(240, 320, CV_8UC1, cv::Scalar(0));
  const cv::Rect hidden(100, 200, 20, 10);
  mask(hidden) = 255;
  cache.Hide(mask);
  for (const std::size_t frame : {0, 1}) {
    const cv::Mat& disparity = One(cache, frame).map.disparity;
    EXPECT_EQ(cv::countNonZero(disparity(hidden)), 0) << frame;
    EXPECT_GT(cv::countNonZero(disparity), 20'000) << frame;
  }
}

TEST_F(ViewCacheOfGround, HoldsMoreThanItsCapacityWhileTheyAreAskedForAtOnce) {
  ViewCache cache(depths_, 1);
  const std::size_t frames[] = {2, 0, 3, 0};
  const auto views = cache.Get(frames);
  ASSERT_EQ(views.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(views[i]->map.stamp_ns, static_cast<StampNs>(frames[i]));
    EXPECT_EQ(views[i]->world_from_rectified.translation,
              depths_[frames[i]].world_from_left.translation);
  }
  EXPECT_EQ(views[1], views[3]);
  for (const std::size_t frame : frames) RemoveFile(frame);
  One(cache, 1);  // then it keeps to it again
  for (const std::size_t frame : {3, 2, 0}) EXPECT_THROW(One(cache, frame), DataError) << frame;
}

}  // namespace
}  // namespace rigmap
