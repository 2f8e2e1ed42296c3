#include "fusion/depth_fusion.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/error.h"
#include "imaging/depth_map.h"
#include "tests/support/seeded_random.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

constexpr double kHeightM = 1.1;

// A camera that looks 30 degrees down upon the ground z = 0 and drives along x.
Rigid3 WorldFromLeft(double x_m) {
  Eigen::Matrix3d level;  // columns: right, down, forward
  level << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const Eigen::AngleAxisd down(-M_PI / 6.0, Eigen::Vector3d::UnitX());
  return {Eigen::Quaterniond(level) * down, {x_m, 0.3 * std::sin(x_m), kHeightM}};
}

// The ground as a stereo frame sees it, with noise of `noise_px` in disparity.
DepthMap GroundSeenFrom(const Rigid3& world_from_left, double noise_px, SeededRandom& random) {
  DepthMap map;
  map.camera = {320, 240, 260.0, 260.0, 160.0, 120.0};
  map.left_from_rectified.rotation = ExpRotation({0.01, -0.02, 0.005});
  map.baseline_m = 0.12;
  map.disparity_sigma_px = 0.25;
  map.disparity = cv::Mat(240, 320, CV_32FC1, cv::Scalar(0.0));
  map.colour = cv::Mat(240, 320, CV_8UC3, cv::Scalar(30, 20, 10));
  const Eigen::Quaterniond rotation = world_from_left.rotation * map.left_from_rectified.rotation;
  for (int row = 0; row < 240; ++row) {
    for (int column = 0; column < 320; ++column) {
      const Eigen::Vector3d ray =
          rotation * map.PointInRectified(column, row, map.camera.fx * map.baseline_m);
      const double depth_m = -kHeightM / ray.z();  // the ray is 1 long in z of rectified axes
      if (ray.z() >= 0.0 || depth_m > 4.0) continue;
      map.disparity.at<float>(row, column) =
          static_cast<float>(map.camera.fx * map.baseline_m / depth_m + random.Normal(noise_px));
    }
  }
  return map;
}

class FuseDepthMapsOfGround : public testing::Test {
 protected:
  void Drive(int frames, double noise_px) {
    SeededRandom random;
    for (int i = 0; i < frames; ++i) {
      const Rigid3 world_from_left = WorldFromLeft(0.17 * i + 0.01 * random.Uniform(0.0, 1.0));
      maps_.push_back(GroundSeenFrom(world_from_left, noise_px, random));
      depths_.push_back({folder_.Path() / std::to_string(i), "key", world_from_left});
    }
    Store();
  }
  void Store() {
    for (std::size_t i = 0; i < maps_.size(); ++i) {
      SaveDepth(depths_[i].path, depths_[i].key, maps_[i]);
    }
  }

  TemporaryFolder folder_;
  std::vector<DepthMap> maps_;
  std::vector<PosedDepth> depths_;
  FusionOptions options_;
};

TEST_F(FuseDepthMapsOfGround, GivesOneThinLayer) {
  Drive(2, 0.0);
  const PointCloud cloud = FuseDepthMaps(depths_, options_);
  ASSERT_GT(cloud.size(), 5000U);
  std::size_t without_normal = 0;  // in the corners of the images
  for (const SurfacePoint& point : cloud) {
    // Disparities are stored in steps of 1/64 px: 4 mm of depth at 4 m, seen at 16 degrees.
    ASSERT_NEAR(point.x_in_world.z(), 0.0, 0.005);
    if (point.normal.isZero()) {
      ++without_normal;
    } else {
      ASSERT_GT(point.normal.z(), 0.99F);
      ASSERT_NEAR(point.normal.norm(), 1.0F, 1e-5F);
    }
    ASSERT_EQ(point.rgb, (std::array<std::uint8_t, 3>{10, 20, 30}));
  }
  EXPECT_LT(without_normal, cloud.size() / 100);
}

TEST_F(FuseDepthMapsOfGround, MergesWhatIsSeenTwice) {
  Drive(1, 0.0);
  options_.min_views = 1;
  const PointCloud once = FuseDepthMaps(depths_, options_);
  depths_.push_back(depths_[0]);
  const PointCloud twice = FuseDepthMaps(depths_, options_);
  EXPECT_GE(twice.size(), once.size());  // twice the observations: more voxels have enough
  options_.min_observations = 1;
  EXPECT_EQ(FuseDepthMaps(depths_, options_).size(),
            FuseDepthMaps(std::span(depths_).first(1), options_).size());
}

TEST_F(FuseDepthMapsOfGround, AveragesNoiseAway) {
  Drive(7, 0.2);
  options_.min_observations = 1;
  const auto rms_m = [&](int neighbours, int min_views) {
    options_.neighbours = neighbours;
    options_.min_views = min_views;
    const PointCloud cloud = FuseDepthMaps(depths_, options_);
    double sum = 0.0;
    for (const SurfacePoint& point : cloud) sum += std::pow(point.x_in_world.z(), 2);
    return std::sqrt(sum / static_cast<double>(cloud.size()));
  };
  EXPECT_LT(rms_m(6, 2), 0.6 * rms_m(0, 1));
}

TEST_F(FuseDepthMapsOfGround, DropsWhatNeighboursSeeThrough) {
  Drive(5, 0.1);
  cv::Mat wrong = maps_[2].disparity(cv::Rect(100, 100, 60, 60));
  wrong *= 1.5F;  // a third nearer: half a metre above the ground
  Store();
  const auto highest_m = [&] {
    double highest = 0.0;
    for (const SurfacePoint& point : FuseDepthMaps(depths_, options_)) {
      highest = std::max(highest, static_cast<double>(point.x_in_world.z()));
    }
    return highest;
  };
  EXPECT_LT(highest_m(), 0.1);
  options_.neighbours = 0;
  options_.min_views = 1;
  options_.min_observations = 1;
  EXPECT_GT(highest_m(), 0.2);
}

TEST_F(FuseDepthMapsOfGround, DoesNotDependOnTheOrderOfFrames) {
  Drive(5, 0.1);
  const PointCloud forwards = FuseDepthMaps(depths_, options_);
  std::reverse(depths_.begin(), depths_.end());
  const PointCloud backwards = FuseDepthMaps(depths_, options_);
  ASSERT_EQ(forwards.size(), backwards.size());
  for (std::size_t i = 0; i < forwards.size(); ++i) {
    ASSERT_LT((forwards[i].x_in_world - backwards[i].x_in_world).norm(), 1e-5F);
  }
}

TEST_F(FuseDepthMapsOfGround, DoesNotDependOnTheNumberOfThreads) {
  Drive(3, 0.1);
  const PointCloud several = FuseDepthMaps(depths_, options_);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const PointCloud one = FuseDepthMaps(depths_, options_);
  ASSERT_EQ(several.size(), one.size());
  for (std::size_t i = 0; i < several.size(); ++i) {
    ASSERT_EQ(several[i].x_in_world, one[i].x_in_world);
    ASSERT_EQ(several[i].normal, one[i].normal);
    ASSERT_EQ(several[i].sigma_m, one[i].sigma_m);
  }
}

TEST_F(FuseDepthMapsOfGround, NamesAMissingDepthMap) {
  Drive(2, 0.0);
  depths_[1].key = "another key";
  EXPECT_THROW(FuseDepthMaps(depths_, options_), DataError);
}

TEST(FusionOptions, RefusesWhatMakesNoSense) {
  EXPECT_NO_THROW(FusionOptions{}.Validate());
  FusionOptions options;
  options.min_views = options.neighbours + 2;
  EXPECT_THROW(options.Validate(), UsageError);
}

}  // namespace
}  // namespace rigmap
