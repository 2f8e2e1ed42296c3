#include "features/corner_tracker.h"

#include <gmock/gmock.h>

#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

#include "correspondence/feature_matching.h"
#include "tests/support/simulated_shot.h"
#include "tests/support/synthetic_rover.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_file.h"

namespace rigmap {
namespace {

class CornerTrackerTest : public testing::Test {
 protected:
  static void SetUpTestSuite() { shot_ = new SimulatedShot(LocCamRig(), 13); }
  static void TearDownTestSuite() { delete shot_; }

  // The shot as if the camera had turned a little: everything moved by `shift` pixels.
  StereoFrame Frame(int stamp, const Eigen::Vector2d& shift) const {
    StereoFrame frame{.stamp_ns = stamp};
    frame.left_path = Write(stamp, "left", shot_->left(), shift);
    frame.right_path = Write(stamp, "right", shot_->right(), shift);
    return frame;
  }
  std::string Write(int stamp, const std::string& eye, const cv::Mat& image,
                    const Eigen::Vector2d& shift) const {
    const cv::Matx23d move(1, 0, shift.x(), 0, 1, shift.y());
    cv::Mat moved;
    cv::warpAffine(image, moved, move, image.size(), cv::INTER_CUBIC, cv::BORDER_REFLECT);
    const auto path = folder_.Path() / (eye + std::to_string(stamp) + ".png");
    cv::imwrite(path.string(), moved);
    return path.string();
  }

  TemporaryFolder folder_;
  inline static SimulatedShot* shot_ = nullptr;
  CornerTracker tracker_{MakeFeatureSetup(LocCamRig(), {}, {}), {}};
};

TEST_F(CornerTrackerTest, FollowsWhatMovesToAPartOfAPixel) {
  const Eigen::Vector2d shift(17.3, -9.6);
  const FrameFeatures first = tracker_.Next(Frame(1, {0.0, 0.0}));
  const FrameFeatures second = tracker_.Next(Frame(2, shift));
  EXPECT_GT(first.features.size(), 1000U);
  EXPECT_EQ(first.tracks.size(), first.features.size());
  EXPECT_TRUE(first.descriptors.empty());
  const auto matches = MatchTracks(first, second);
  EXPECT_GT(matches.size(), 0.8 * static_cast<double>(first.features.size()));
  int exact = 0;
  for (const FeatureMatch& match : matches) {
    const Eigen::Vector2d moved =
        second.features[match.b].left - first.features[match.a].left - shift;
    exact += moved.norm() < 0.15 ? 1 : 0;
  }
  EXPECT_GT(exact, 0.95 * static_cast<double>(matches.size()));
  // What has come into view gets tracks of its own.
  EXPECT_GT(second.features.size(), matches.size());
  EXPECT_EQ(std::set(second.tracks.begin(), second.tracks.end()).size(), second.tracks.size());
  int stereo_matches = 0;
  for (const Feature& feature : second.features) stereo_matches += feature.right ? 1 : 0;
  EXPECT_GT(stereo_matches, 500);
}

TEST_F(CornerTrackerTest, LooksWhereTheGroundMovesTo) {
  // Too far for the window alone, which is followed on the image itself only; not from where the
  // frames before lead to.
  CornerOptions options;
  options.pyramid_levels = 0;
  CornerTracker tracker(MakeFeatureSetup(LocCamRig(), {}, {}), options);
  tracker.Next(Frame(1, {0.0, 0.0}));
  FrameFeatures last = tracker.Next(Frame(2, {2.0, 0.8}));
  int stamp = 3;
  for (const double shift : {5.0, 10.0, 17.0, 26.0, 37.0}) {
    FrameFeatures next = tracker.Next(Frame(stamp++, {shift, 0.4 * shift}));
    const auto matches = MatchTracks(last, next);
    EXPECT_GT(matches.size(), 0.6 * static_cast<double>(last.features.size())) << shift;
    last = std::move(next);
  }
}

TEST_F(CornerTrackerTest, EndsAllTracksAtAFrameThatCannotBeRead) {
  const FrameFeatures first = tracker_.Next(Frame(1, {0.0, 0.0}));
  StereoFrame damaged = Frame(2, {0.0, 0.0});
  WriteTestFile(damaged.right_path, "no image");
  const FrameFeatures second = tracker_.Next(damaged);
  EXPECT_TRUE(second.features.empty());
  EXPECT_THAT(second.unreadable_images, testing::ElementsAre(damaged.right_path));
  const FrameFeatures third = tracker_.Next(Frame(3, {0.0, 0.0}));
  EXPECT_EQ(third.features.size(), first.features.size());
  EXPECT_TRUE(MatchTracks(first, third).empty());
}

}  // namespace
}  // namespace rigmap
