#include "features/stereo_matches.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "tests/support/seeded_random.h"
#include "tests/support/simulated_shot.h"
#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

double Median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.at(values.size() / 2);
}

// The rig whose right camera is turned about its x axis, so that its rows move by `rows` px.
StereoRig WithRowsOff(StereoRig rig, double rows) {
  const double angle_rad = rows / rig.right.camera.fy;
  rig.right_from_left =
      Rigid3{ExpRotation({angle_rad, 0.0, 0.0}), Eigen::Vector3d::Zero()} * rig.right_from_left;
  return rig;
}

cv::Mat Disturbed(const cv::Mat& image, double sigma, int seed) {
  cv::Mat noise(image.size(), CV_16SC1), sum;
  cv::RNG(static_cast<std::uint64_t>(seed)).fill(noise, cv::RNG::NORMAL, 0.0, sigma);
  cv::add(image, noise, sum, cv::noArray(), CV_8U);
  return sum;
}

class StereoMatchesTest : public testing::Test {
 protected:
  static void SetUpTestSuite() { shot_ = new SimulatedShot(LocCamRig(), 11); }
  static void TearDownTestSuite() { delete shot_; }

  static StereoImages Images() {
    StereoImages images;
    images.left = Disturbed(shot_->left(), 2.0, 1);
    images.right = Disturbed(shot_->right(), 2.0, 2);
    cv::GaussianBlur(images.left, images.left, cv::Size(5, 5), 0.8);
    cv::GaussianBlur(images.right, images.right, cv::Size(5, 5), 0.8);
    images.right_mask = cv::Mat(images.right.size(), CV_8UC1, cv::Scalar(255));
    return images;
  }

  std::vector<Eigen::Vector2d> SomePixels(int count) {
    std::vector<Eigen::Vector2d> pixels;
    for (int i = 0; i < count; ++i) {
      pixels.emplace_back(random_.Uniform(0.0, 1023.0), random_.Uniform(0.0, 767.0));
    }
    return pixels;
  }

  Eigen::Vector2d Truth(const Eigen::Vector2d& left) const {
    return *Project(rig_.right.camera, rig_.right_from_left * *shot_->HitAt(left));
  }

  StereoRig rig_ = LocCamRig();
  SeededRandom random_;
  inline static SimulatedShot* shot_ = nullptr;
};

TEST_F(StereoMatchesTest, AreRightToAFewHundredthsOfAPixel) {
  const auto left = SomePixels(800);
  // At half resolution (the default for this size) and at full.
  for (const double limit_mpx : {0.6, 1.0}) {
    FeatureOptions options;
    options.half_resolution_above_mpx = limit_mpx;
    const StereoMatches stereo_matches = FindStereoMatches(Images(), rig_, left, options);
    ASSERT_EQ(stereo_matches.found.size(), left.size());
    std::vector<double> disparity_errors_px, row_errors_px;
    int possible = 0, wild = 0;
    for (std::size_t i = 0; i < left.size(); ++i) {
      const Eigen::Vector2d truth = Truth(left[i]);
      possible += truth.x() > 20.0 && truth.y() > 20.0 && truth.y() < 748.0 ? 1 : 0;
      if (!stereo_matches.found[i]) continue;
      const Eigen::Vector2d error = stereo_matches.found[i]->right - truth;
      disparity_errors_px.push_back(std::abs(error.x()));
      row_errors_px.push_back(std::abs(error.y()));
      wild += error.norm() > 0.5 ? 1 : 0;
    }
    EXPECT_GT(disparity_errors_px.size(), 0.8 * possible);
    EXPECT_LT(Median(disparity_errors_px), 0.05);
    EXPECT_LT(Median(row_errors_px), 0.05);
    EXPECT_LE(wild, static_cast<int>(disparity_errors_px.size() / 100));
  }
}

// As level ground is sheared: a keypoint that moves by a row takes its match along by 0.9 to 1.1
// rows and a tenth of a pixel of disparity.
TEST_F(StereoMatchesTest, MoveWithTheirKeypointsAsTheSurfaceDoes) {
  const auto left = SomePixels(800);
  const StereoMatches stereo_matches = FindStereoMatches(Images(), rig_, left, {});
  std::vector<double> errors_px, unmoved_px;
  for (std::size_t i = 0; i < left.size(); ++i) {
    if (!stereo_matches.found[i]) continue;
    const Eigen::Vector2d move = random_.Noise(1.0).head<2>();
    if (!shot_->HitAt(left[i] + move)) continue;
    const Eigen::Vector2d moved = Truth(left[i] + move) - Truth(left[i]);
    errors_px.push_back((stereo_matches.found[i]->right_from_left * move - moved).norm());
    unmoved_px.push_back((move - moved).norm());
  }
  EXPECT_GT(errors_px.size(), 300U);
  EXPECT_LT(Median(errors_px), 0.5 * Median(unmoved_px));
}

TEST_F(StereoMatchesTest, AreOneToOne) {
  auto left = SomePixels(300);
  // Many claim the same position.
  for (int i = 0; i < 100; ++i) left.push_back(left[i] + random_.Noise(0.05).head<2>());
  const StereoMatches stereo_matches = FindStereoMatches(Images(), rig_, left, {});
  std::vector<std::pair<int, int>> pixels;
  for (const auto& match : stereo_matches.found) {
    if (match) pixels.emplace_back(cvRound(match->right.x()), cvRound(match->right.y()));
  }
  EXPECT_GT(pixels.size(), 150u);
  std::sort(pixels.begin(), pixels.end());
  EXPECT_EQ(std::adjacent_find(pixels.begin(), pixels.end()), pixels.end());
  EXPECT_GE(stereo_matches.epipolar_errors_px.size(), pixels.size());
}

TEST_F(StereoMatchesTest, AreFoundWhereRowsAreOff) {
  const auto left = SomePixels(500);
  FeatureOptions options;
  options.half_resolution_above_mpx = 1.0;  // at full resolution the back search is the narrowest
  const StereoMatches straight = FindStereoMatches(Images(), rig_, left, options);
  const auto count = [](const StereoMatches& stereo_matches) {
    return std::count_if(stereo_matches.found.begin(), stereo_matches.found.end(),
                         [](const auto& match) { return match.has_value(); });
  };
  for (const double rows : {2.0, -2.0, 3.0}) {
    // The calibration is off, not the images.
    const StereoRig wrong = WithRowsOff(rig_, rows);
    const StereoMatches found = FindStereoMatches(Images(), wrong, left, options);
    EXPECT_GT(count(found), 0.85 * count(straight)) << rows;
    std::vector<double> errors_px, offs_px;
    for (float error : found.epipolar_errors_px) errors_px.push_back(error);
    EXPECT_NEAR(std::abs(Median(errors_px)), std::abs(rows), 0.2) << rows;
    // A turn moves rows near the upper and lower border by up to a third more; beyond that, and a
    // tenth of a pixel for how well places are found, are wrong stereo matches.
    const double allowed_px = std::abs(rows) / 3.0 + 0.1;
    int wild = 0;
    for (std::size_t i = 0; i < left.size(); ++i) {
      if (!found.found[i]) continue;
      const auto error = EpipolarErrorPx(wrong, left[i], found.found[i]->right);
      ASSERT_TRUE(error);
      wild += std::abs(std::abs(*error) - std::abs(rows)) > allowed_px ? 1 : 0;
      offs_px.push_back((found.found[i]->right - Truth(left[i])).norm());
    }
    EXPECT_LE(wild, static_cast<int>(offs_px.size() / 100)) << rows;
    EXPECT_LT(Median(offs_px), 0.1) << rows;
  }
}

TEST_F(StereoMatchesTest, RightMaskIsHonoured) {
  StereoImages images = Images();
  images.right_mask.colRange(400, 700).setTo(0);
  const StereoMatches stereo_matches = FindStereoMatches(images, rig_, SomePixels(300), {});
  int found = 0;
  for (const auto& match : stereo_matches.found) {
    if (!match) continue;
    ++found;
    const Eigen::Vector2d& right = match->right;
    EXPECT_FALSE(right.x() > 399.5 && right.x() < 699.5) << right.transpose();
  }
  EXPECT_GT(found, 80);
}

TEST_F(StereoMatchesTest, NoneOnFlatGrey) {
  StereoImages flat = Images();
  flat.left.setTo(120);
  flat.right.setTo(120);
  const auto left = SomePixels(200);
  const StereoMatches nothing = FindStereoMatches(flat, rig_, left, {});
  ASSERT_EQ(nothing.found.size(), left.size());
  for (const auto& match : nothing.found) EXPECT_FALSE(match);
  EXPECT_TRUE(nothing.epipolar_errors_px.empty());
  // Nor where only noise is left of them.
  flat.left = Disturbed(flat.left, 3.0, 3);
  flat.right = Disturbed(flat.right, 3.0, 4);
  for (const auto& match : FindStereoMatches(flat, rig_, left, {}).found) EXPECT_FALSE(match);
}

TEST_F(StereoMatchesTest, NoneWhereTheTextureRepeats) {
  StereoImages images = Images();
  for (cv::Mat* image : {&images.left, &images.right}) {
    for (int y = 0; y < image->rows; ++y) {
      for (int x = 0; x < image->cols; ++x) {
        image->at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(
            120.0 + 40.0 * std::sin(x * 0.4) + 40.0 * std::sin(y * 0.3));
      }
    }
  }
  const StereoMatches stereo_matches = FindStereoMatches(images, rig_, SomePixels(200), {});
  const auto found = std::count_if(stereo_matches.found.begin(), stereo_matches.found.end(),
                                   [](const auto& match) { return match.has_value(); });
  EXPECT_LE(found, 4);
}

TEST_F(StereoMatchesTest, SameImagesSameStereoMatches) {
  const auto left = SomePixels(100);
  const StereoMatches first = FindStereoMatches(Images(), rig_, left, {});
  const StereoMatches second = FindStereoMatches(Images(), rig_, left, {});
  for (std::size_t i = 0; i < left.size(); ++i) {
    ASSERT_EQ(first.found[i].has_value(), second.found[i].has_value());
    if (!first.found[i]) continue;
    EXPECT_EQ(first.found[i]->right, second.found[i]->right);
    EXPECT_EQ(first.found[i]->right_from_left, second.found[i]->right_from_left);
  }
  EXPECT_EQ(first.epipolar_errors_px, second.epipolar_errors_px);
}

TEST(EpipolarErrorPx, IsZeroForTruePairsAndTheRowsForShiftedOnes) {
  SeededRandom random;
  const StereoRig rig = LocCamRig();
  for (int i = 0; i < 100; ++i) {
    const double z_m = random.Uniform(1.0, 10.0);
    const Eigen::Vector3d x(z_m * random.Uniform(-0.4, 0.4), z_m * random.Uniform(-0.3, 0.3), z_m);
    const Eigen::Vector2d left = *Project(rig.left.camera, x);
    const Eigen::Vector2d right = *Project(rig.right.camera, rig.right_from_left * x);
    EXPECT_NEAR(*EpipolarErrorPx(rig, left, right), 0.0, 1e-6);
    const double off_px = random.Uniform(-2.0, 2.0);
    // The distortion shrinks the rim by some percent.
    EXPECT_NEAR(*EpipolarErrorPx(rig, left, right + Eigen::Vector2d(0.0, off_px)), off_px,
                0.25 * std::abs(off_px));
  }
}

}  // namespace
}  // namespace rigmap
