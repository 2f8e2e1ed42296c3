#include "simulation/internal/truth_depth.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "core/file.h"
#include "tests/simulation/small_world.h"
#include "tests/support/seeded_random.h"
#include "tests/support/synthetic_rover.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

Camera SmallView() {
  return {.width = 160, .height = 120, .fx = 100.0, .fy = 100.0, .cx = 79.5, .cy = 59.5};
}

TEST(TruthDepth, ViewCoversBothImages) {
  const StereoRig rig = LocCamRig();
  const Camera view = TruthDepthCamera(rig);
  SeededRandom random;
  for (const Eye eye : kEyes) {
    const Camera& camera = rig.Of(eye).camera;
    for (int i = 0; i < 1000; ++i) {
      const Eigen::Vector2d pixel(random.Uniform(-0.5, camera.width - 0.5),
                                  random.Uniform(-0.5, camera.height - 0.5));
      const auto normalised = Undistort(camera, pixel);
      ASSERT_TRUE(normalised);
      EXPECT_TRUE(view.Contains(Distort(view, *normalised)));
    }
  }
}

TEST(TruthDepth, ViewOfLocCamIsThatOfTheBeach) {
  StereoRig rig = LocCamRig();
  rig.left.camera.cx = 497.714642524;
  rig.left.camera.cy = 398.772652193;
  rig.right.camera.cx = 481.938040669;
  rig.right.camera.cy = 391.459972472;
  const Camera view = TruthDepthCamera(rig);
  EXPECT_EQ(view.width, 1458);
  EXPECT_EQ(view.height, 1066);
  EXPECT_EQ(view.fx, 900.0);
  EXPECT_EQ(view.cx, 728.5);
  EXPECT_EQ(view.cy, 532.5);
}

TEST(TruthDepth, AgreesWithSingleRays) {
  const Rigid3 world_from_left = SmallDrive().front();
  const Camera view = SmallView();
  const cv::Mat depth = RenderTruthDepth(SmallWorld(), view, world_from_left);
  ASSERT_EQ(depth.type(), CV_16UC1);
  SeededRandom random;
  int near = 0, sky = 0;
  for (int i = 0; i < 2000; ++i) {
    const int u = static_cast<int>(random.Uniform(0, view.width));
    const int v = static_cast<int>(random.Uniform(0, view.height));
    const Eigen::Vector3d ray = Undistort(view, Eigen::Vector2d(u, v))->homogeneous().normalized();
    const auto hit = SmallWorld().Cast(world_from_left.translation, world_from_left.rotation * ray);
    const double z_m = hit ? (world_from_left.Inverse() * hit->position).z() : 0.0;
    const double found_m = depth.at<std::uint16_t>(v, u) * kTruthDepthUnit_m;
    const bool in_range = hit && z_m < 32.7;
    if (in_range) {
      EXPECT_NEAR(found_m, z_m, 0.5 * kTruthDepthUnit_m + 1e-5 * z_m);
    }
    if (!hit || z_m > 32.8) {
      EXPECT_EQ(found_m, 0.0);
    }
    near += in_range;
    sky += !in_range;
  }
  EXPECT_GT(near, 500);
  EXPECT_GT(sky, 50);
}

TEST(TruthDepth, FilesReadBack) {
  const TemporaryFolder folder;
  const Camera view = SmallView();
  const cv::Mat depth = RenderTruthDepth(SmallWorld(), view, SmallDrive().back());
  WriteTruthDepth(folder.Path() / "depth", 20, depth);
  WriteTruthDepthCamera(folder.Path() / "depth", view);
  const cv::Mat read =
      cv::imread((folder.Path() / "depth" / "depth_0020.png").string(), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(read.type(), CV_16UC1);
  EXPECT_EQ(cv::norm(read, depth, cv::NORM_INF), 0.0);
  const auto json = nlohmann::json::parse(ReadTextFile(folder.Path() / "depth" / "camera.json"));
  EXPECT_EQ(json["fx"], view.fx);
  EXPECT_EQ(json["cy"], view.cy);
  EXPECT_EQ(json["unit_m"], 0.0005);
  EXPECT_EQ(json["invalid"], 0);
}

}  // namespace
}  // namespace rigmap
