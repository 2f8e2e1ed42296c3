#include "dense/dense_matcher.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/error.h"
#include "tests/support/seeded_random.h"
#include "tests/support/synthetic_rover.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

// A textured plane n . x = h in left camera axes, seen by both eyes of a rig.
struct Plane {
  Eigen::Vector3d normal = Eigen::Vector3d(0.1, -0.8, -0.6).normalized();
  double offset_m = -1.2;
};

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

// Smooth random texture: waves of 1.5 to 12 cm in all directions of the plane.
class Texture {
 public:
  explicit Texture(SeededRandom& random) {
    for (int i = 0; i < 40; ++i) {
      const double direction = random.Uniform(0.0, 2.0 * std::numbers::pi);
      const double length_m = 0.015 * std::pow(8.0, random.Uniform(0.0, 1.0));
      const double wave_number = 2.0 * std::numbers::pi / length_m;
      waves_.push_back({wave_number * std::cos(direction), wave_number * std::sin(direction),
                        random.Uniform(0.0, 2.0 * std::numbers::pi)});
    }
  }
  double At(double u_m, double v_m) const {
    double sum = 0.0;
    for (const auto& wave : waves_) sum += std::sin(wave[0] * u_m + wave[1] * v_m + wave[2]);
    return 120.0 + 18.0 * sum;
  }

 private:
  std::vector<Eigen::Vector3d> waves_;
};

cv::Mat Render(const Camera& camera, const Rigid3& left_from_eye, const Plane& plane,
               const Texture& texture) {
  cv::Mat image(camera.height, camera.width, CV_8UC1, cv::Scalar(0));
  const Eigen::Vector3d u_axis = plane.normal.unitOrthogonal();
  const Eigen::Vector3d v_axis = plane.normal.cross(u_axis);
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.cols; ++column) {
      const auto normalised = Undistort(camera, {column, row});
      if (!normalised) continue;
      const Eigen::Vector3d ray = left_from_eye.rotation * normalised->homogeneous();
      const double along =
          (plane.offset_m - plane.normal.dot(left_from_eye.translation)) / plane.normal.dot(ray);
      if (along <= 0.0) continue;
      const Eigen::Vector3d x = left_from_eye.translation + along * ray;
      image.at<uchar>(row, column) =
          cv::saturate_cast<uchar>(texture.At(u_axis.dot(x), v_axis.dot(x)));
    }
  }
  return image;
}

class DenseMatcherOnPlane : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    SeededRandom random;
    const Texture texture(random);
    frame_ = {1, folder_.Path() / "left.png", folder_.Path() / "right.png"};
    cv::imwrite(frame_.left_path, Render(rig_.left.camera, {}, plane_, texture));
    cv::imwrite(frame_.right_path,
                Render(rig_.right.camera, rig_.right_from_left.Inverse(), plane_, texture));
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
    return map.camera.fx * map.baseline_m * plane_.normal.dot(ray) / plane_.offset_m;
  }

  TemporaryFolder folder_;
  StereoRig rig_ = SmallRig();
  Plane plane_;
  StereoFrame frame_;
  DenseOptions options_;
};

INSTANTIATE_TEST_SUITE_P(Methods, DenseMatcherOnPlane, testing::Values("sgm", "bm"));

TEST_P(DenseMatcherOnPlane, FindsThePlane) {
  if (options_.method == std::string("bm")) options_.block_px = 15;
  const DepthMap map = DenseMatcher(rig_, options_, {}).Compute(frame_);
  const std::vector<double> errors = Errors(map);
  ASSERT_GT(errors.size(), rig_.left.camera.width * rig_.left.camera.height * 0.5);
  EXPECT_NEAR(errors[errors.size() / 2], 0.0, 0.05) << "median, px";
  EXPECT_GT(errors[errors.size() / 20], -0.5) << "5 %, px";
  EXPECT_LT(errors[errors.size() * 19 / 20], 0.5) << "95 %, px";
}

TEST_P(DenseMatcherOnPlane, HasNoBiasAgainstSparsePoints) {
  SeededRandom random;
  const DepthMap map = DenseMatcher(rig_, options_, {}).Compute(frame_);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3d ray(random.Uniform(-0.4, 0.4), random.Uniform(-0.3, 0.4), 1.0);
    points.push_back(ray * plane_.offset_m / plane_.normal.dot(ray));
  }
  const auto bias_px = DisparityBiasPx(map, points);
  ASSERT_TRUE(bias_px);
  EXPECT_NEAR(*bias_px, 0.0, 0.05);
}

TEST_P(DenseMatcherOnPlane, KeepsToItsRangeAndMasks) {
  options_.min_depth_m = 1.3;
  options_.max_range_m = 1.7;
  rig_.left.calibrated_region = PixelRegion{0, 0, rig_.left.camera.width / 2, 10000};
  const DepthMap map = DenseMatcher(rig_, options_, {}).Compute(frame_);
  int known = 0;
  for (int row = 0; row < map.disparity.rows; ++row) {
    for (int column = 0; column < map.disparity.cols; ++column) {
      const double found = map.disparity.at<float>(row, column);
      if (found <= 0.0) continue;
      ++known;
      ASSERT_GE(map.Depth(found), options_.min_depth_m - 1e-6);
      ASSERT_LE(map.Depth(found), options_.max_range_m + 1e-6);
      const Eigen::Vector3d x = map.PointInRectified(column, row, found);
      const auto pixel = Project(rig_.left.camera, map.left_from_rectified * x);
      ASSERT_TRUE(pixel);
      ASSERT_LE(pixel->x(), rig_.left.camera.width / 2 + 0.5);
    }
  }
  EXPECT_GT(known, 5000);
}

TEST_P(DenseMatcherOnPlane, IsTheSameTwice) {
  const DenseMatcher matcher(rig_, options_, {});
  EXPECT_EQ(
      cv::norm(matcher.Compute(frame_).disparity, matcher.Compute(frame_).disparity, cv::NORM_INF),
      0.0);
}

TEST(DenseOptions, DerivesTheRangeFromTheDepthSigma) {
  DenseOptions options;
  const double depth_m = options.MaxDepth(840.0, 0.12);
  const double sigma_m = depth_m * depth_m / (840.0 * 0.12) * options.disparity_sigma_px;
  EXPECT_NEAR(sigma_m, options.max_depth_sigma_m, 1e-12);
  options.max_range_m = 3.0;
  EXPECT_EQ(options.MaxDepth(840.0, 0.12), 3.0);
}

TEST(DenseOptions, RefusesWhatMakesNoSense) {
  EXPECT_NO_THROW(DenseOptions{}.Validate());
  DenseOptions options;
  options.method = "guess";
  EXPECT_THROW(options.Validate(), UsageError);
  options = {};
  options.block_px = 4;
  EXPECT_THROW(options.Validate(), UsageError);
}

}  // namespace
}  // namespace rigmap
