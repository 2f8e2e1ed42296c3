#include "registration/frame_cloud.h"

#include <gmock/gmock.h>

#include <set>
#include <tuple>

#include "core/error.h"
#include "tests/support/message_of.h"

namespace rigmap {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kFocal_px = 200.0, kBaseline_m = 0.1, kDepth_m = 2.0;

// A wall that faces the camera.
DepthMap Wall() {
  DepthMap map;
  map.camera.width = 160;
  map.camera.height = 120;
  map.camera.fx = map.camera.fy = kFocal_px;
  map.camera.cx = 79.5;
  map.camera.cy = 59.5;
  map.baseline_m = kBaseline_m;
  const auto disparity_px = static_cast<float>(kFocal_px * kBaseline_m / kDepth_m);
  map.disparity = cv::Mat(120, 160, CV_32FC1, cv::Scalar(disparity_px));
  map.disparity_sigma = cv::Mat(120, 160, CV_32FC1, cv::Scalar(0.1));
  map.colour = cv::Mat(120, 160, CV_8UC3, cv::Scalar(30, 20, 10));
  return map;
}

CloudLimits Limits() {
  return {.grid_m = 0.05,
          .min_depth_m = 0.0,
          .max_depth_m = 10.0,
          .min_height_m = -100.0,
          .max_height_m = 100.0,
          .denoise_neighbours = 4,
          .denoise_deviations = 1.0};
}

TEST(CloudOf, HasOnePointPerBoxOnTheSurface) {
  CloudLimits limits = Limits();
  limits.denoise_neighbours = 0;
  const FrameCloud cloud = CloudOf(Wall(), limits);
  // 1.6 m by 1.2 m in boxes of 5 cm.
  EXPECT_NEAR(static_cast<double>(cloud.size()), 32.0 * 24.0, 60.0);
  std::set<std::tuple<int, int, int>> boxes;
  for (const CloudPoint& point : cloud) {
    EXPECT_NEAR(point.x_in_left.z(), kDepth_m, 1e-4);
    EXPECT_LT(point.normal.z(), -0.999F);
    EXPECT_EQ(point.rgb, (std::array<std::uint8_t, 3>{10, 20, 30}));
    // z^2 / (f b) sigma_d
    EXPECT_NEAR(point.sigma_m, kDepth_m * kDepth_m / (kFocal_px * kBaseline_m) * 0.1, 1e-4);
    const Eigen::Array3i box = (point.x_in_left / 0.05F).array().floor().cast<int>();
    EXPECT_TRUE(boxes.insert({box[0], box[1], box[2]}).second);
  }
}

TEST(CloudOf, MasksByDepthAndHeight) {
  CloudLimits limits = Limits();
  limits.max_depth_m = 1.9;
  EXPECT_THAT(CloudOf(Wall(), limits), IsEmpty());
  limits = Limits();
  limits.min_depth_m = 2.1;
  EXPECT_THAT(CloudOf(Wall(), limits), IsEmpty());
  limits = Limits();
  limits.min_height_m = 0.0;
  limits.max_height_m = 0.3;
  const FrameCloud band = CloudOf(Wall(), limits);
  ASSERT_FALSE(band.empty());
  for (const CloudPoint& point : band) {
    EXPECT_LE(point.x_in_left.y(), 0.0F);
    EXPECT_GE(point.x_in_left.y(), -0.3F);
  }
}

TEST(CloudOf, LeavesOutWhatIsUnsureOrStray) {
  DepthMap map = Wall();
  map.disparity_sigma.colRange(0, 80).setTo(kUnsurePx);
  // A speck that floats before the wall.
  map.disparity(cv::Rect(120, 60, 2, 2)).setTo(20.0);
  const FrameCloud cloud = CloudOf(map, Limits());
  ASSERT_FALSE(cloud.empty());
  for (const CloudPoint& point : cloud) {
    EXPECT_GE(point.x_in_left.x(), 0.0F);
    EXPECT_NEAR(point.x_in_left.z(), kDepth_m, 1e-3);
  }
}

TEST(CloudOf, NothingKnownIsNoCloud) {
  DepthMap map = Wall();
  map.disparity.setTo(0.0);
  EXPECT_THAT(CloudOf(map, Limits()), IsEmpty());
}

TEST(LimitsFor, FollowFromRigAndNearGround) {
  StereoRig rig;
  rig.left.camera.fx = rig.left.camera.fy = 840.0;
  rig.right_from_left.translation.x() = -0.12;
  const CloudLimits limits = LimitsFor(rig, 1.5, {});
  EXPECT_DOUBLE_EQ(limits.grid_m, 0.05);
  // There, a tenth of a pixel is a box.
  const double depth_m = limits.max_depth_m;
  EXPECT_NEAR(depth_m * depth_m / (840.0 * 0.12) * 0.1, limits.grid_m, 1e-9);
  EXPECT_GT(limits.max_height_m, 1e6);
  CloudOptions options;
  options.max_above_m = 0.5;
  options.max_below_m = 2.0;
  EXPECT_EQ(LimitsFor(rig, 1.5, options).max_height_m, 0.5);
  EXPECT_EQ(LimitsFor(rig, 1.5, options).min_height_m, -2.0);
}

TEST(LimitsFor, RefusesWhatCannotBe) {
  StereoRig rig;
  rig.left.camera.fx = rig.left.camera.fy = 840.0;
  rig.right_from_left.translation.x() = -0.12;
  CloudOptions options;
  options.min_depth_m = 3.0;
  options.max_depth_m = 2.0;
  EXPECT_THAT(MessageOf<UsageError>([&] { LimitsFor(rig, 1.5, options); }),
              HasSubstr("registration.max_depth_m"));
  options = {};
  options.grid_m = 0.001;
  options.max_depth_m = 10.0;
  EXPECT_THAT(MessageOf<UsageError>([&] { LimitsFor(rig, 1.5, options); }),
              HasSubstr("registration.grid_m"));
}

}  // namespace
}  // namespace rigmap
