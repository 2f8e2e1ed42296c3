#include "imaging/depth_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/seeded_random.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

// Random disparities in steps of 1/16 px, a fifth of them unknown.
DepthMap RandomMap() {
  SeededRandom random;
  DepthMap map;
  map.stamp_ns = 1448551416619000000;
  map.camera = {64, 48, 80.0, 80.0, 31.5, 23.5};
  map.left_from_rectified.rotation = random.Rotation(0.05);
  map.baseline_m = 0.12;
  map.disparity.create(48, 64, CV_32FC1);
  map.disparity_sigma.create(48, 64, CV_32FC1);
  map.smoothed_pct.create(48, 64, CV_8UC1);
  map.colour.create(48, 64, CV_8UC3);
  for (int row = 0; row < 48; ++row) {
    for (int column = 0; column < 64; ++column) {
      const bool known = random.Uniform(0.0, 1.0) < 0.8;
      map.disparity.at<float>(row, column) =
          known ? static_cast<float>(std::floor(random.Uniform(16.0, 16000.0))) / 16.0F : 0.0F;
      map.disparity_sigma.at<float>(row, column) =
          static_cast<float>(std::ceil(random.Uniform(0.0, 255.0))) / 128.0F;
      map.smoothed_pct.at<uchar>(row, column) = static_cast<uchar>(random.Uniform(0.0, 101.0));
      const auto value = static_cast<uchar>(random.Uniform(0.0, 256.0));
      map.colour.at<cv::Vec3b>(row, column) = {value, 7, 255};
    }
  }
  return map;
}

TEST(StoredDepth, ComesBackAsItWas) {
  const TemporaryFolder folder;
  const DepthMap map = RandomMap();
  SaveDepth(folder.Path() / "depth", "key", map);
  const auto loaded = LoadDepth(folder.Path() / "depth", "key");
  ASSERT_TRUE(loaded);
  EXPECT_EQ(loaded->stamp_ns, map.stamp_ns);
  EXPECT_EQ(loaded->baseline_m, map.baseline_m);
  EXPECT_EQ(loaded->camera.cx, map.camera.cx);
  EXPECT_EQ(cv::norm(loaded->disparity, map.disparity, cv::NORM_INF), 0.0);
  const cv::Mat known = map.disparity > 0.0F;
  EXPECT_EQ(cv::norm(loaded->disparity_sigma, map.disparity_sigma, cv::NORM_INF, known), 0.0);
  EXPECT_EQ(cv::norm(loaded->smoothed_pct, map.smoothed_pct, cv::NORM_INF, known), 0.0);
  EXPECT_EQ(cv::norm(loaded->colour, map.colour, cv::NORM_INF, known), 0.0);
  EXPECT_FALSE(LoadDepth(folder.Path() / "depth", "another key"));
  EXPECT_FALSE(LoadDepth(folder.Path() / "nowhere", "key"));
}

TEST(DepthMap, SigmaIsTheChangeOfDepthWithDisparity) {
  const DepthMap map = RandomMap();
  constexpr double kStep = 1e-6;
  const double slope = (map.Depth(5.0) - map.Depth(5.0 + kStep)) / kStep;
  EXPECT_NEAR(map.DepthSigma(5.0, 0.25), slope * 0.25, 1e-6);
}

TEST(DisparityBias, FindsACommonShiftDespiteWrongPoints) {
  SeededRandom random;
  DepthMap map = RandomMap();
  std::vector<Eigen::Vector3d> points;
  constexpr double kBiasPx = 0.3;
  for (int row = 2; row < 46; row += 4) {
    for (int column = 2; column < 62; column += 4) {
      const double disparity_px = random.Uniform(4.0, 20.0);
      map.disparity.at<float>(row, column) = static_cast<float>(disparity_px + kBiasPx);
      const bool wrong = random.Uniform(0.0, 1.0) < 0.2;
      points.push_back(map.left_from_rectified *
                       map.PointInRectified(column, row, wrong ? 50.0 : disparity_px));
    }
  }
  const auto bias_px = DisparityBiasPx(map, points);
  ASSERT_TRUE(bias_px);
  EXPECT_NEAR(*bias_px, kBiasPx, 1e-4);
  EXPECT_FALSE(DisparityBiasPx(map, std::span(points).first(kMinBiasPoints - 1)));
}

}  // namespace
}  // namespace rigmap
