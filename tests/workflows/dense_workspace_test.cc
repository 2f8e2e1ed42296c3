#include "workflows/stages/dense_workspace.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>

#include "colmap/model_io.h"
#include "core/file.h"
#include "core/job.h"
#include "imaging/rectifier.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;

constexpr double kWallM = 2.0;

// Three frames before a wall, each 0.1 m right of the one before; of the second nobody knows depth.
class DenseWorkspace : public testing::Test {
 protected:
  DenseWorkspace() {
    const Camera camera{.width = 80, .height = 60, .fx = 90, .fy = 90, .cx = 39, .cy = 30};
    part_.rig.left.camera = part_.rig.right.camera = camera;
    part_.rig.right_from_left.translation = {-0.12, 0.0, 0.0};
    for (int i = 0; i < 3; ++i) {
      const std::string path = folder_.Path() / fmt::format("{}.png", i);
      cv::imwrite(path, cv::Mat(60, 80, CV_8UC3, cv::Scalar(10, 20, 100 + i)));
      dataset_.frames.push_back({1000 + i, path, path});
      TimedPose& pose = part_.trajectory.emplace_back();
      pose.world_from_left.translation = {0.1 * i, 0.0, 0.0};
      if (i != 1) AddDepth(i);
    }
    dataset_.rig = part_.rig;
  }

  void AddDepth(int frame) {
    const Rectifier rectifier(part_.rig);
    DepthMap map;
    map.stamp_ns = dataset_.frames[frame].stamp_ns;
    map.camera = rectifier.RectifiedCamera();
    map.left_from_rectified.rotation = rectifier.LeftFromRectified();
    map.baseline_m = rectifier.BaselineM();
    const cv::Size size(map.camera.width, map.camera.height);
    map.disparity = cv::Mat(size, CV_32F, cv::Scalar(map.camera.fx * map.baseline_m / kWallM));
    map.disparity_sigma = cv::Mat(size, CV_32F, cv::Scalar(0.1));
    map.colour = cv::Mat(size, CV_8UC3, cv::Scalar::all(7));
    const FrameFile file{fmt::format("{}.bin", frame), "key"};
    SaveDepth(file.In(folder_.Path()), file.key, map);
    depths_.frames.push_back(frame);
    depths_.files.push_back(file);
  }

  // A point of the wall that the left images of these frames show.
  void AddPosedPoint(const Eigen::Vector3d& x_in_world, const std::vector<int>& frames) {
    PosedPoint& point = part_.points.emplace_back(x_in_world);
    for (const int frame : frames) {
      const auto pixel = Project(part_.rig.left.camera,
                                 part_.trajectory[frame].world_from_left.Inverse() * x_in_world);
      point.in_left.push_back({frame, 0, Eye::kLeft, *pixel});
    }
  }

  SparseModel Publish() {
    Publication publication(folder_.Path(), {"dense_workspace"});
    Job(2, true).Run([&] {
      PublishDenseWorkspace(dataset_, part_, depths_, {.root = folder_.Path(), .threads = 2},
                            publication);
    });
    return ReadModel(Workspace() / "sparse");
  }
  fs::path Workspace() const { return folder_.Path() / "dense_workspace"; }

  TemporaryFolder folder_;
  Dataset dataset_;
  PosedPart part_;
  DepthIndex depths_;
};

// Each observation of each point is its projection.
void ExpectConsistent(const SparseModel& model) {
  ASSERT_EQ(model.cameras.size(), 1U);
  for (const SparseImage& image : model.images) {
    for (const SparseKeypoint& keypoint : image.keypoints) {
      const SparsePoint& point = model.points.at(*keypoint.point_id - 1);
      const auto pixel =
          Project(model.cameras[0].camera, image.camera_from_model * point.x_in_model);
      ASSERT_TRUE(pixel);
      EXPECT_LT((*pixel - keypoint.pixel).norm(), 1e-6);
    }
  }
}

TEST_F(DenseWorkspace, HoldsTheFramesWithDepth) {
  AddPosedPoint({0.1, 0.2, kWallM}, {0, 1, 2});
  const SparseModel model = Publish();
  ASSERT_EQ(model.images.size(), 2U);
  const Camera& camera = model.cameras.at(0).camera;
  for (const SparseImage& image : model.images) {
    const cv::Mat view = cv::imread((Workspace() / "images" / image.name).string());
    EXPECT_EQ(view.size(), cv::Size(camera.width, camera.height));
    for (const char* kind : {"depth_maps", "normal_maps"}) {
      EXPECT_TRUE(fs::exists(Workspace() / "stereo" / kind / (image.name + ".geometric.bin")));
    }
  }
  EXPECT_EQ(ReadTextFile(Workspace() / "stereo" / "fusion.cfg"), "1000.png\n1002.png\n");
  EXPECT_LT((model.images[1].camera_from_model.Inverse().translation -
             part_.trajectory[2].world_from_left.translation)
                .norm(),
            1e-12);
}

TEST_F(DenseWorkspace, HoldsThePointsThatTwoOfItsViewsShow) {
  AddPosedPoint({0.1, 0.2, kWallM}, {0, 1, 2});
  AddPosedPoint({0.0, 0.1, kWallM}, {0, 1});
  AddPosedPoint({0.2, -0.2, kWallM}, {0, 2});
  const SparseModel model = Publish();
  ASSERT_EQ(model.points.size(), 2U);
  for (const SparsePoint& point : model.points) {
    EXPECT_EQ(point.track.size(), 2U);
    EXPECT_THAT(point.rgb, ElementsAre(100, 20, 10));  // of the first
    EXPECT_LT(point.error_px, 1e-6);
  }
  ExpectConsistent(model);
}

TEST_F(DenseWorkspace, SamplesTheDepthOfAPartWithoutPoints) {
  const SparseModel model = Publish();
  EXPECT_GT(model.points.size(), 100U);
  for (const SparsePoint& point : model.points) {
    EXPECT_EQ(point.track.size(), 2U);
    EXPECT_NEAR(point.x_in_model.z(), kWallM, 0.01);  // kept in steps of 1/64 px
  }
  ExpectConsistent(model);
}

TEST_F(DenseWorkspace, IsNotThereWithoutDepth) {
  depths_ = {};
  Publication publication(folder_.Path(), {"dense_workspace"});
  PublishDenseWorkspace(dataset_, part_, depths_, {.root = folder_.Path()}, publication);
  EXPECT_FALSE(fs::exists(Workspace()));
  EXPECT_TRUE(publication.written().empty());
}

}  // namespace
}  // namespace rigmap
