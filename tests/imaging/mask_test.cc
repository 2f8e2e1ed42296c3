#include "imaging/mask.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "tests/support/message_of.h"
#include "tests/support/seeded_random.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 240;
constexpr int kHorizon = 80;

RigEye EyeOf(int width, int height) {
  RigEye eye;
  eye.camera.width = width;
  eye.camera.height = height;
  return eye;
}

cv::Mat Everything() { return cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(255)); }

// Ground of the given mean with strong texture, and above the horizon a smooth sky with noise.
cv::Mat Scene(int ground, int sky) {
  SeededRandom random;
  cv::Mat scene(kHeight, kWidth, CV_8UC1);
  for (int row = 0; row < kHeight; ++row) {
    for (int column = 0; column < kWidth; ++column) {
      const double value = row < kHorizon ? sky + random.Normal(2.0) : ground + random.Normal(60.0);
      scene.at<uchar>(row, column) = cv::saturate_cast<uchar>(value);
    }
  }
  return scene;
}

double UsableShare(const cv::Mat& mask, const cv::Rect& region) {
  return cv::countNonZero(mask(region)) / static_cast<double>(region.area());
}

const cv::Rect kSkyRegion(0, 0, kWidth, kHorizon - 12);
const cv::Rect kGroundRegion(0, kHorizon + 12, kWidth, kHeight - kHorizon - 12);

TEST(StaticMask, HoldsExactlyTheCalibratedRegion) {
  RigEye eye = EyeOf(40, 30);
  EXPECT_EQ(cv::countNonZero(StaticMask(eye)), 40 * 30);
  eye.calibrated_region = PixelRegion{5, 6, 20, 25};
  const cv::Mat mask = StaticMask(eye);
  EXPECT_EQ(cv::countNonZero(mask), 16 * 20);
  EXPECT_EQ(mask.at<uchar>(6, 5), 255);
  EXPECT_EQ(mask.at<uchar>(25, 20), 255);
  EXPECT_EQ(mask.at<uchar>(26, 20), 0);
}

TEST(StaticMask, LeavesOutZeroPixelsOfTheMaskFile) {
  const TemporaryFolder folder;
  cv::Mat file(30, 40, CV_8UC1, cv::Scalar(1));
  file(cv::Rect(0, 20, 40, 10)).setTo(0);
  RigEye eye = EyeOf(40, 30);
  eye.mask_path = folder.Path() / "mask.png";
  cv::imwrite(eye.mask_path, file);
  const cv::Mat mask = StaticMask(eye);
  EXPECT_EQ(cv::norm(mask == 255, file == 1, cv::NORM_INF), 0.0);
  eye.camera.width = 41;
  EXPECT_THROW(StaticMask(eye), DataError);
}

TEST(StaticMask, ThatLeavesNothingIsRefusedByName) {
  const TemporaryFolder folder;
  RigEye eye = EyeOf(40, 30);
  eye.mask_path = folder.Path() / "mask.png";
  cv::imwrite(eye.mask_path, cv::Mat::zeros(30, 40, CV_8UC1));
  EXPECT_THAT(MessageOf<DataError>([&] { StaticMask(eye); }),
              testing::HasSubstr("mask.png: expected a mask that is zero where"));
}

TEST(UsableMask, LeavesOutSaturatedAreasButNotGlints) {
  cv::Mat grey = Scene(110, 40);
  const cv::Rect area(100, 150, 60, 40);
  const cv::Rect glint(200, 150, 6, 6);
  grey.setTo(240, grey > 240);
  grey(area).setTo(255);
  grey(glint).setTo(255);
  const cv::Mat mask = UsableMask(grey, Everything(), {});
  EXPECT_EQ(UsableShare(mask, area), 0.0);
  EXPECT_EQ(UsableShare(mask, glint), 1.0);
  // The margin, 3 px, and no more.
  EXPECT_EQ(mask.at<uchar>(170, area.x - 3), 0);
  EXPECT_EQ(mask.at<uchar>(170, area.x - 4), 255);
}

TEST(UsableMask, LeavesOutABrightSkyAndNoGround) {
  for (const int sky : {170, 215, 255}) {
    const cv::Mat mask = UsableMask(Scene(110, sky), Everything(), {});
    EXPECT_EQ(UsableShare(mask, kSkyRegion), 0.0) << "sky " << sky;
    EXPECT_GT(UsableShare(mask, kGroundRegion), 0.999) << "sky " << sky;
  }
}

TEST(UsableMask, KeepsADarkSkyAndDarkWalls) {
  const cv::Mat mask = UsableMask(Scene(110, 20), Everything(), {});
  EXPECT_EQ(cv::countNonZero(mask), kWidth * kHeight);
}

TEST(UsableMask, KeepsATexturedBrightHillside) {
  cv::Mat grey;
  cv::flip(Scene(90, 90), grey, 0);  // smooth below, textured above
  grey.rowRange(0, 2 * kHeight / 3) += 60;
  MaskOptions options;
  options.saturation_level = 256;
  EXPECT_GT(UsableShare(UsableMask(grey, Everything(), options), {0, 0, kWidth, kHeight / 2}),
            0.999);
}

TEST(UsableMask, LeavesOutBlackAreasButNoSpecks) {
  cv::Mat grey = Scene(110, 110);
  const cv::Rect wall(40, 80, 60, 50), speck(150, 100, 8, 8);
  grey(wall) = 1;
  grey(speck) = 0;
  const cv::Mat mask = UsableMask(grey, Everything(), {});
  EXPECT_EQ(UsableShare(mask, wall), 0.0);
  EXPECT_EQ(cv::countNonZero(mask), kWidth * kHeight - wall.area());
  EXPECT_EQ(cv::countNonZero(UsableMask(grey, Everything(), {.black_level = 0})), kWidth * kHeight);
}

TEST(UsableMask, CanLeaveTheSkyAlone) {
  MaskOptions options;
  options.sky = false;
  const cv::Mat mask = UsableMask(Scene(110, 215), Everything(), options);
  EXPECT_EQ(UsableShare(mask, kSkyRegion), 1.0);
}

TEST(UsableMask, NeverAddsToTheStaticMask) {
  cv::Mat fixed = Everything();
  fixed(cv::Rect(50, 100, 70, 60)).setTo(0);
  const cv::Mat mask = UsableMask(Scene(110, 215), fixed, {});
  EXPECT_EQ(cv::countNonZero(mask & (fixed == 0)), 0);
}

TEST(MaskOptions, RefusesWhatMakesNoSense) {
  EXPECT_NO_THROW(RequireValid(MaskOptions{}));
  MaskOptions options;
  options.saturation_level = 0;
  EXPECT_THROW(RequireValid(options), UsageError);
  options = {};
  options.sky_lowest_share = 1.0;
  EXPECT_THROW(RequireValid(options), UsageError);
}

}  // namespace
}  // namespace rigmap
