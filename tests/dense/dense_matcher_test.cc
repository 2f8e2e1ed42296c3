#include "dense/dense_matcher.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "core/error.h"
#include "dense/internal/disparity.h"
#include "tests/support/seeded_random.h"
#include "tests/support/simulated_shot.h"
#include "tests/support/synthetic_rover.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

// The rig of LocCam at half the resolution.
StereoRig SmallRig() {
  StereoRig rig = LocCamRig();
  for (RigEye* eye : {&rig.left, &rig.right}) {
    Camera& camera = eye->camera;
    camera.width /= 2;
    camera.height /= 2;
    camera.fx /= 2.0;
    camera.fy /= 2.0;
    camera.cx = 0.5 * (camera.cx + 0.5) - 0.5;
    camera.cy = 0.5 * (camera.cy + 0.5) - 0.5;
  }
  return rig;
}

class DenseMatcherOnSand : public testing::TestWithParam<DenseMethod> {
 protected:
  // As simulating takes most of the time.
  static void SetUpTestSuite() { shot_ = new SimulatedShot(SmallRig(), 17); }
  static void TearDownTestSuite() { delete shot_; }

  void SetUp() override {
    frame_ = {1, folder_.Path() / "left.png", folder_.Path() / "right.png"};
    cv::imwrite(frame_.left_path, shot_->left());
    cv::imwrite(frame_.right_path, shot_->right());
    options_.method = GetParam();
    options_.max_range_m = 4.0;
  }

  // Found less true disparity of every known pixel, sorted.
  std::vector<double> Errors(const DepthMap& map) const {
    std::vector<double> errors;
    for (int row = 0; row < map.disparity.rows; ++row) {
      for (int column = 0; column < map.disparity.cols; ++column) {
        const double found = map.disparity.at<float>(row, column);
        if (found > 0.0) errors.push_back(found - TrueDisparity(map, row, column));
      }
    }
    std::sort(errors.begin(), errors.end());
    return errors;
  }

  double TrueDisparity(const DepthMap& map, int row, int column) const {
    const Eigen::Vector3d ray = map.left_from_rectified.rotation *
                                Eigen::Vector3d((column - map.camera.cx) / map.camera.fx,
                                                (row - map.camera.cy) / map.camera.fy, 1.0);
    const Eigen::Vector3d hit = map.left_from_rectified.Inverse() * *shot_->HitAlong(ray);
    return map.camera.fx * map.baseline_m / hit.z();
  }

  TemporaryFolder folder_;
  StereoRig rig_ = SmallRig();
  StereoFrame frame_;
  double nearest_m_ = 0.4;
  DenseOptions options_;
  inline static SimulatedShot* shot_ = nullptr;
};

INSTANTIATE_TEST_SUITE_P(Methods, DenseMatcherOnSand,
                         testing::Values(DenseMethod::kSgm, DenseMethod::kBm),
                         [](const auto& method) { return NameOf(method.param); });

TEST_P(DenseMatcherOnSand, FindsTheSand) {
  if (options_.method == DenseMethod::kBm) options_.block_px = 15;
  const DepthMap map = DenseMatcher(rig_, nearest_m_, options_, {}).Compute(frame_);
  const std::vector<double> errors = Errors(map);
  ASSERT_GT(errors.size(), rig_.left.camera.width * rig_.left.camera.height * 0.5);
  EXPECT_NEAR(errors[errors.size() / 2], 0.0, 0.05) << "median, px";
  EXPECT_GT(errors[errors.size() / 20], -0.5) << "5 %, px";
  EXPECT_LT(errors[errors.size() * 19 / 20], 0.5) << "95 %, px";
}

// A rig that gives: the right eye sees the sand as if it had turned by minus that.
TEST_P(DenseMatcherOnSand, FollowsARightEyeThatTurns) {
  if (options_.method == DenseMethod::kBm) options_.block_px = 15;
  const double turn = 0.5 / rig_.right.camera.fx;
  rig_.right_from_left.rotation = ExpRotation({0.0, -turn, 0.0}) * rig_.right_from_left.rotation;
  const auto median = [&](const DepthMap& map) {
    const std::vector<double> errors = Errors(map);
    return errors[errors.size() / 2];
  };
  const DenseMatcher matcher(rig_, nearest_m_, options_, {});
  EXPECT_GT(std::abs(median(matcher.Compute(frame_))), 0.4) << "px";
  EXPECT_NEAR(median(matcher.Compute(frame_, {0.0, turn, 0.0})), 0.0, 0.05) << "px";
}

// A camera that was exposed half as long.
TEST_P(DenseMatcherOnSand, FindsAsMuchWhereOneEyeIsDarker) {
  const DenseMatcher matcher(rig_, nearest_m_, options_, {});
  const std::size_t alike = Errors(matcher.Compute(frame_)).size();
  for (const auto* path : {&frame_.left_path, &frame_.right_path}) {
    const cv::Mat bright = cv::imread(*path);
    cv::imwrite(*path, 0.5 * bright);
    const std::vector<double> errors = Errors(matcher.Compute(frame_));
    cv::imwrite(*path, bright);
    ASSERT_GT(static_cast<double>(errors.size()), 0.95 * static_cast<double>(alike)) << *path;
    EXPECT_GT(errors[errors.size() / 20], -0.5) << "5 %, px";
    EXPECT_LT(errors[errors.size() * 19 / 20], 0.5) << "95 %, px";
  }
}

TEST(MatchDisparity, FindsNothingInAStripThatIsThinnerThanABlock) {
  DenseOptions options;
  options.method = DenseMethod::kBm;
  options.block_px = 15;
  const cv::Mat grey(200, 300, CV_8UC1, cv::Scalar(90));
  cv::Mat mask(grey.size(), CV_8UC1, cv::Scalar(0));
  mask.rowRange(100, 110).setTo(255);
  const cv::Mat disparity = MatchDisparity({grey, grey, mask, mask}, 64.0, options);
  EXPECT_EQ(disparity.size(), grey.size());
  EXPECT_EQ(cv::countNonZero(disparity), 0);
}

TEST_P(DenseMatcherOnSand, HasNoBiasAgainstSparsePoints) {
  SeededRandom random;
  const DepthMap map = DenseMatcher(rig_, nearest_m_, options_, {}).Compute(frame_);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 500; ++i) {
    points.push_back(*shot_->HitAlong({random.Uniform(-0.4, 0.4), random.Uniform(-0.3, 0.4), 1.0}));
  }
  const auto bias_px = DisparityBiasPx(map, points);
  ASSERT_TRUE(bias_px);
  EXPECT_NEAR(*bias_px, 0.0, 0.05);
}

// A strip that feature detection takes for as good a thing as any. Sand on both sides of it would
// be carried over.
TEST_P(DenseMatcherOnSand, KnowsNothingWhereAWholeBlockIsBlack) {
  const cv::Range strip(230, 241);
  ASSERT_LT(strip.size(), MaskOptions().saturation_width_px);
  for (const cv::Mat& image : {shot_->left(), shot_->right()}) {
    cv::Mat dimmed = image.clone();
    dimmed.rowRange(strip).setTo(0);
    cv::imwrite(image.data == shot_->left().data ? frame_.left_path : frame_.right_path, dimmed);
  }
  const DepthMap map = DenseMatcher(rig_, nearest_m_, options_, {}).Compute(frame_);
  cv::Mat black, inner;
  cv::inRange(map.colour, cv::Scalar::all(0), cv::Scalar::all(2), black);
  cv::erode(black, inner, cv::Mat::ones(options_.block_px, options_.block_px, CV_8U));
  EXPECT_GT(cv::countNonZero(inner), rig_.left.camera.width * 5);
  EXPECT_EQ(cv::countNonZero(inner & (map.disparity > 0.0)), 0);
  EXPECT_GT(cv::countNonZero(map.disparity > 0.0), 50000);
}

TEST_P(DenseMatcherOnSand, KeepsToItsRangeAndMasks) {
  nearest_m_ = 1.3;
  options_.max_range_m = 1.7;
  rig_.left.calibrated_region = PixelRegion{0, 0, rig_.left.camera.width / 2, 10000};
  const DepthMap map = DenseMatcher(rig_, nearest_m_, options_, {}).Compute(frame_);
  int known = 0;
  for (int row = 0; row < map.disparity.rows; ++row) {
    for (int column = 0; column < map.disparity.cols; ++column) {
      const double found = map.disparity.at<float>(row, column);
      if (found <= 0.0) continue;
      ++known;
      ASSERT_GE(map.Depth(found), nearest_m_ - 1e-6);
      ASSERT_LE(map.Depth(found), options_.max_range_m + 1e-6);
      const Eigen::Vector3d x = map.PointInRectified(column, row, found);
      const auto pixel = Project(rig_.left.camera, map.left_from_rectified * x);
      ASSERT_TRUE(pixel);
      ASSERT_LE(pixel->x(), rig_.left.camera.width / 2 + 0.5);
    }
  }
  EXPECT_GT(known, 5000);
}

TEST_P(DenseMatcherOnSand, LeavesOutWhatItKnowsTooLittleOf) {
  options_.max_range_m = 0.0;
  const auto worst_pct = [&] {
    const DepthMap map = DenseMatcher(rig_, nearest_m_, options_, {}).Compute(frame_);
    double worst = 0.0;
    for (int row = 0; row < map.disparity.rows; ++row) {
      for (int column = 0; column < map.disparity.cols; ++column) {
        const float found = map.disparity.at<float>(row, column);
        if (found <= 0.0F) continue;
        worst = std::max(worst, 100.0 * map.disparity_sigma.at<float>(row, column) / found);
      }
    }
    return worst;
  };
  EXPECT_GT(worst_pct(), 2.0);
  EXPECT_LE(worst_pct(), options_.max_depth_sigma_pct);
  options_.max_depth_sigma_pct = 1.5;
  EXPECT_GT(worst_pct(), 0.0);
  EXPECT_LE(worst_pct(), 1.5);
}

TEST_P(DenseMatcherOnSand, KnowsNothingWhereItsMaskIsZero) {
  const Camera& camera = rig_.left.camera;
  cv::Mat mask(camera.height, camera.width, CV_8UC1, cv::Scalar(255));
  const cv::Rect ignored(camera.width / 2, camera.height / 2, 120, 80);
  mask(ignored) = 0;
  const DepthMap all = DenseMatcher(rig_, nearest_m_, options_, {}).Compute(frame_);
  const DepthMap masked = DenseMatcher(rig_, nearest_m_, options_, {}, mask).Compute(frame_);
  const auto count_in_ignored = [&](const DepthMap& map) {
    int known = 0;
    for (int row = 0; row < map.disparity.rows; ++row) {
      for (int column = 0; column < map.disparity.cols; ++column) {
        const double found = map.disparity.at<float>(row, column);
        if (found <= 0.0) continue;
        const Eigen::Vector3d x = map.PointInRectified(column, row, found);
        const Eigen::Vector2d pixel = *Project(camera, map.left_from_rectified * x);
        // Half a pixel inside: masks are rectified to the nearest pixel.
        known += pixel.x() > ignored.x && pixel.y() > ignored.y && pixel.x() < ignored.br().x - 1 &&
                 pixel.y() < ignored.br().y - 1;
      }
    }
    return known;
  };
  EXPECT_GT(count_in_ignored(all), 1000);
  EXPECT_EQ(count_in_ignored(masked), 0);
  EXPECT_GT(cv::countNonZero(masked.disparity), cv::countNonZero(all.disparity) / 2);
}

TEST_P(DenseMatcherOnSand, IsTheSameWithAMaskThatAllowsAll) {
  const cv::Mat mask(rig_.left.camera.height, rig_.left.camera.width, CV_8UC1, cv::Scalar(255));
  EXPECT_EQ(cv::norm(DenseMatcher(rig_, nearest_m_, options_, {}, mask).Compute(frame_).disparity,
                     DenseMatcher(rig_, nearest_m_, options_, {}).Compute(frame_).disparity,
                     cv::NORM_INF),
            0.0);
}

TEST_P(DenseMatcherOnSand, IsTheSameTwice) {
  const DenseMatcher matcher(rig_, nearest_m_, options_, {});
  EXPECT_EQ(
      cv::norm(matcher.Compute(frame_).disparity, matcher.Compute(frame_).disparity, cv::NORM_INF),
      0.0);
}

TEST(DenseOptions, RefusesWhatMakesNoSense) {
  EXPECT_NO_THROW(RequireValid(DenseOptions{}));
  DenseOptions options;
  options.block_px = 4;
  EXPECT_THROW(RequireValid(options), UsageError);
  options = {};
  options.refinement_px = 8;
  EXPECT_THROW(RequireValid(options), UsageError);
  options = {};
  options.least_sigma_px = 0.0;
  EXPECT_THROW(RequireValid(options), UsageError);
  options = {};
  options.block_px = 3;
  EXPECT_NO_THROW(RequireValid(options));
  options.method = DenseMethod::kBm;
  EXPECT_THROW(RequireValid(options), UsageError);
  options.block_px = 19;
  EXPECT_NO_THROW(RequireValid(options));
  options.method = DenseMethod::kSgm;
  EXPECT_THROW(RequireValid(options), UsageError);
  options = {};
  options.large_step_cost = options.small_step_cost;
  EXPECT_THROW(RequireValid(options), UsageError);
  options = {};
  options.min_depth_m = 2.0;
  options.max_range_m = 2.0;
  EXPECT_THROW(RequireValid(options), UsageError);
}

}  // namespace
}  // namespace rigmap
