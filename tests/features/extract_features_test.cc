#include "features/extract_features.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "correspondence/stereo_points.h"
#include "features/keypoints.h"
#include "tests/support/simulated_shot.h"
#include "tests/support/synthetic_rover.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

class ExtractFeaturesTest : public testing::Test {
 protected:
  // As simulating takes most of the time.
  static void SetUpTestSuite() { shot_ = new SimulatedShot(LocCamRig(), 13); }
  static void TearDownTestSuite() { delete shot_; }

  void SetUp() override {
    frame_.stamp_ns = 1234;
    frame_.left_path = (folder_.Path() / "left.png").string();
    frame_.right_path = (folder_.Path() / "right.png").string();
    left_ = shot_->left().clone();
    cv::imwrite(frame_.left_path, left_);
    cv::imwrite(frame_.right_path, shot_->right());
  }

  StereoRig rig_ = LocCamRig();
  TemporaryFolder folder_;
  StereoFrame frame_;
  cv::Mat left_;
  inline static SimulatedShot* shot_ = nullptr;
};

TEST_F(ExtractFeaturesTest, PointsLieOnTheSand) {
  const FeatureSetup setup = MakeFeatureSetup(rig_, {}, {});
  const FrameFeatures found = ExtractFeatures(frame_, setup);
  EXPECT_EQ(found.stamp_ns, 1234);
  EXPECT_GT(found.features.size(), 1000u);
  EXPECT_EQ(found.descriptors.size(), found.features.size());
  EXPECT_EQ(found.patches.size(), found.features.size());
  EXPECT_EQ(found.usable_share, 1.0);
  int stereo_matches = 0, on_sand = 0;
  const auto points = TriangulateFeatures(found.features, rig_, 0.15);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i]) continue;
    ++stereo_matches;
    const Eigen::Vector3d truth = *shot_->HitAt(found.features[i].left);
    on_sand += (points[i]->x_in_left - truth).norm() < 2.0 * points[i]->depth_sigma_m ? 1 : 0;
  }
  EXPECT_GT(stereo_matches, 700);
  EXPECT_GT(on_sand, 0.98 * stereo_matches);
  for (float error : found.epipolar_errors_px) EXPECT_LT(std::abs(error), 4.0F);
}

TEST_F(ExtractFeaturesTest, FaintKeypointsCountWhereTheOtherEyeShowsThemToo) {
  const FeatureOptions options{.max_keypoints = 3000, .contrast_threshold = 0.012};
  const FrameFeatures found = ExtractFeatures(frame_, MakeFeatureSetup(rig_, options, {}));
  const Keypoints all =
      DetectKeypoints(left_, cv::Mat(left_.size(), CV_8UC1, cv::Scalar(255)), options);
  int faint = 0, faint_in_both = 0, strong_in_one = 0;
  auto feature = found.features.begin();  // in the order of the keypoints
  for (std::size_t i = 0; i < all.pixels.size(); ++i) {
    const bool is_faint = all.found[i].response < options.contrast_threshold;
    const bool is_kept = feature != found.features.end() && feature->left == all.pixels[i];
    EXPECT_TRUE(is_kept || is_faint);
    faint += is_faint;
    if (!is_kept) continue;
    faint_in_both += is_faint && feature->right;
    strong_in_one += !is_faint && !feature->right;
    EXPECT_FALSE(is_faint && !feature->right);
    ++feature;
  }
  EXPECT_EQ(feature, found.features.end());
  EXPECT_EQ(found.descriptors.size(), found.features.size());
  EXPECT_GT(faint_in_both, 100);
  EXPECT_GT(faint - faint_in_both, 20);
  EXPECT_GT(strong_in_one, 10);
}

TEST_F(ExtractFeaturesTest, PatchesAreCutAroundTheRoundedPixel) {
  const FrameFeatures found = ExtractFeatures(frame_, MakeFeatureSetup(rig_, {}, {}));
  cv::Mat smooth;
  cv::GaussianBlur(left_, smooth, cv::Size(5, 5), 0.8);
  for (std::size_t i = 0; i < found.features.size(); ++i) {
    const Eigen::Vector2d& at = found.features[i].left;
    const int x0 = static_cast<int>(std::round(at.x())), y0 = static_cast<int>(std::round(at.y()));
    for (const auto& [dx, dy] : {std::pair(0, 0), std::pair(-10, 3), std::pair(10, 10)}) {
      const int x = std::clamp(x0 + dx, 0, smooth.cols - 1);
      const int y = std::clamp(y0 + dy, 0, smooth.rows - 1);
      ASSERT_EQ(found.patches[i][(kPatchRadius + dy) * kPatchSize + kPatchRadius + dx],
                smooth.at<std::uint8_t>(y, x));
    }
  }
}

TEST_F(ExtractFeaturesTest, SampledFeaturesAreAsExtractedOnes) {
  const FeatureSetup setup = MakeFeatureSetup(rig_, {}, {});
  const FrameFeatures found = ExtractFeatures(frame_, setup);
  std::vector<Eigen::Vector2d> pixels;
  for (std::size_t i = 0; i < 200; ++i) pixels.push_back(found.features[i].left);
  const auto sampled = SampleFeatures(frame_, pixels, setup);
  ASSERT_EQ(sampled.size(), pixels.size());
  int with_match = 0;
  for (std::size_t i = 0; i < sampled.size(); ++i) {
    ASSERT_TRUE(sampled[i]);
    EXPECT_EQ(sampled[i]->feature.left, pixels[i]);
    EXPECT_EQ(sampled[i]->patch, found.patches[i]);
    if (!sampled[i]->feature.right || !found.features[i].right) continue;
    EXPECT_EQ(*sampled[i]->feature.right, *found.features[i].right);
    ++with_match;
  }
  EXPECT_GT(with_match, 120);
}

TEST_F(ExtractFeaturesTest, NothingIsSampledWhereNothingCanBeSeen) {
  left_(cv::Rect(100, 100, 200, 200)).setTo(255);  // saturated
  cv::imwrite(frame_.left_path, left_);
  const FeatureSetup setup = MakeFeatureSetup(rig_, {}, {});
  const auto sampled =
      SampleFeatures(frame_, {{200.0, 200.0}, {500.0, 400.0}, {-3.0, 10.0}, {2000.0, 10.0}}, setup);
  ASSERT_EQ(sampled.size(), 4u);
  EXPECT_FALSE(sampled[0]);
  EXPECT_TRUE(sampled[1]);
  EXPECT_FALSE(sampled[2]);
  EXPECT_FALSE(sampled[3]);
  std::ofstream(frame_.right_path) << "no image";
  EXPECT_TRUE(SampleFeatures(frame_, {{500.0, 400.0}}, setup).empty());
}

TEST_F(ExtractFeaturesTest, MasksOfTheRigAndOfTheImageAreHonoured) {
  rig_.left.calibrated_region = PixelRegion{0, 0, 799, 639};
  rig_.left.mask_path = (folder_.Path() / "mask.png").string();
  cv::Mat mask(768, 1024, CV_8UC1, cv::Scalar(255));
  mask.rowRange(500, 768).setTo(0);
  cv::imwrite(rig_.left.mask_path, mask);
  left_(cv::Rect(100, 100, 200, 200)).setTo(255);  // saturated
  cv::imwrite(frame_.left_path, left_);
  const FrameFeatures found = ExtractFeatures(frame_, MakeFeatureSetup(rig_, {}, {}));
  EXPECT_GT(found.features.size(), 300u);
  EXPECT_NEAR(found.usable_share, (800.0 * 500.0 - 206.0 * 206.0) / (1024.0 * 768.0), 0.002);
  for (const Feature& feature : found.features) {
    EXPECT_LT(feature.left.x(), 799.5);
    EXPECT_LT(feature.left.y(), 499.5);
    EXPECT_FALSE(cv::Rect(100, 100, 200, 200)
                     .contains({cvRound(feature.left.x()), cvRound(feature.left.y())}));
  }
}

TEST_F(ExtractFeaturesTest, BlackImagesGiveAnEmptyFrame) {
  cv::imwrite(frame_.left_path, cv::Mat::zeros(768, 1024, CV_8UC1));
  cv::imwrite(frame_.right_path, cv::Mat::zeros(768, 1024, CV_8UC1));
  const FrameFeatures found = ExtractFeatures(frame_, MakeFeatureSetup(rig_, {}, {}));
  EXPECT_EQ(found.stamp_ns, 1234);
  EXPECT_TRUE(found.features.empty());
  EXPECT_TRUE(found.epipolar_errors_px.empty());
}

TEST_F(ExtractFeaturesTest, DamagedImageGivesAnEmptyFrameThatNamesIt) {
  std::filesystem::resize_file(frame_.right_path,
                               std::filesystem::file_size(frame_.right_path) / 2);
  const FrameFeatures found = ExtractFeatures(frame_, MakeFeatureSetup(rig_, {}, {}));
  EXPECT_EQ(found.stamp_ns, 1234);
  EXPECT_TRUE(found.features.empty());
  EXPECT_TRUE(found.patches.empty());
  EXPECT_EQ(found.usable_share, 0.0);
  EXPECT_EQ(found.unreadable_images, std::vector{frame_.right_path});
  cv::imwrite(frame_.right_path, cv::Mat(5, 5, CV_8UC1, cv::Scalar(0)));
  EXPECT_THROW(ExtractFeatures(frame_, MakeFeatureSetup(rig_, {}, {})), DataError);
}

TEST_F(ExtractFeaturesTest, OfALoneImageAreThoseOfItsEye) {
  const FeatureSetup setup = MakeFeatureSetup(rig_, {}, {});
  const FrameFeatures both = ExtractFeatures(frame_, setup);
  const FrameFeatures left = ExtractLoneFeatures({7, Eye::kLeft, frame_.left_path}, 16, setup);
  EXPECT_EQ(left.stamp_ns, 7);
  ASSERT_EQ(left.features.size(), both.features.size());
  EXPECT_EQ(left.descriptors, both.descriptors);
  EXPECT_EQ(left.features[5].left, both.features[5].left);
  EXPECT_FALSE(left.features[5].right);
  const FrameFeatures right = ExtractLoneFeatures({7, Eye::kRight, frame_.right_path}, 16, setup);
  EXPECT_GT(right.features.size(), 1000u);
  EXPECT_NE(right.features[5].left, both.features[5].left);
}

TEST_F(ExtractFeaturesTest, ADamagedLoneImageShowsNothing) {
  std::filesystem::resize_file(frame_.left_path, 100);
  const FrameFeatures found =
      ExtractLoneFeatures({7, Eye::kLeft, frame_.left_path}, 16, MakeFeatureSetup(rig_, {}, {}));
  EXPECT_TRUE(found.features.empty());
  EXPECT_EQ(found.unreadable_images.size(), 1u);
}

TEST_F(ExtractFeaturesTest, MissingImagesAreNamed) {
  frame_.right_path += ".gone";
  try {
    ExtractFeatures(frame_, MakeFeatureSetup(rig_, {}, {}));
    FAIL() << "no error";
  } catch (const DataError& error) {
    EXPECT_NE(std::string(error.what()).find("right.png.gone"), std::string::npos);
  }
  rig_.left.mask_path = "/nowhere/mask.png";
  EXPECT_THROW(MakeFeatureSetup(rig_, {}, {}), DataError);
}

}  // namespace
}  // namespace rigmap
