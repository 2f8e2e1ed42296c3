#include "workflows/stages/sparse_output.h"

#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>

#include "colmap/model_io.h"
#include "core/file.h"
#include "tests/support/seeded_random.h"
#include "tests/support/temporary_folder.h"
#include "workflows/stages/database.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;

// Three frames of small coloured images, of which the second is not adjusted, and points before
// the other two.
class SparseOutput : public testing::Test {
 protected:
  SparseOutput() {
    const Camera camera{.width = 64, .height = 48, .fx = 50, .fy = 51, .cx = 31, .cy = 24};
    dataset_.rig.left.camera = dataset_.rig.right.camera = camera;
    dataset_.rig.right.camera.fx = 52;
    dataset_.rig.right_from_left = {ExpRotation({0.01, -0.02, 0.0}), {-0.12, 0.001, 0.002}};
    for (int i = 0; i < 3; ++i) {
      dataset_.frames.push_back({1000 + i, WriteImage("l", i), WriteImage("r", i)});
    }
    adjustment_.rig = dataset_.rig;
    adjustment_.world_from_left = {Rigid3(), std::nullopt,
                                   Rigid3{ExpRotation({0.02, 0.1, 0.0}), {0.1, 0.0, 0.2}}};
    for (int i = 0; i < 20; ++i) AddPoint(random_.Vector(0.4) + Eigen::Vector3d(0.0, 0.0, 2.0));
  }

  // The colour tells frame, column and row.
  std::string WriteImage(const std::string& eye, int frame) {
    cv::Mat image(48, 64, CV_8UC3);
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 64; ++x) {
        image.at<cv::Vec3b>(y, x) = {static_cast<std::uint8_t>(50 * frame),
                                     static_cast<std::uint8_t>(3 * y),
                                     static_cast<std::uint8_t>(2 * x)};
      }
    }
    const auto path = (folder_.Path() / (eye + std::to_string(frame) + ".PNG")).string();
    cv::imwrite(path, image);
    return path;
  }

  Eigen::Vector2d Pixel(int frame, Eye eye, const Eigen::Vector3d& x) const {
    Eigen::Vector3d x_in_eye = adjustment_.world_from_left[frame]->Inverse() * x;
    if (eye == Eye::kRight) x_in_eye = adjustment_.rig.right_from_left * x_in_eye;
    return *Project(dataset_.rig.Of(eye).camera, x_in_eye);
  }
  void AddPoint(const Eigen::Vector3d& x) {
    AdjustedPoint point{x, {}};
    for (const int frame : {0, 2}) {
      for (const Eye eye : kEyes) {
        point.observations.push_back({frame, 7, eye, Pixel(frame, eye, x)});
      }
    }
    adjustment_.points.push_back(point);
  }

  TemporaryFolder folder_;
  SeededRandom random_;
  Dataset dataset_;
  Adjustment adjustment_;
};

TEST_F(SparseOutput, HoldsBothEyesOfTheAdjustedFrames) {
  const Rigid3 world_from_gauge = random_.Motion(2.0);
  const SparseModel model = MakeSparseOutput(dataset_, adjustment_, world_from_gauge);
  std::vector<std::string> names;
  for (const SparseImage& image : model.images) names.push_back(image.name);
  EXPECT_THAT(names,
              ElementsAre("left/1000.png", "right/1000.png", "left/1002.png", "right/1002.png"));
  const Rigid3 world_from_left = world_from_gauge * *adjustment_.world_from_left[2];
  const Rigid3 left = model.images[2].camera_from_model * world_from_left;
  EXPECT_LT(left.translation.norm() + AngleOf(left.rotation), 1e-9);
  const Rigid3 right =
      model.images[3].camera_from_model * world_from_left * dataset_.rig.right_from_left.Inverse();
  EXPECT_LT(right.translation.norm() + AngleOf(right.rotation), 1e-9);
}

TEST_F(SparseOutput, PointsProjectOntoTheKeypointsOfTheirTracks) {
  const SparseModel model = MakeSparseOutput(dataset_, adjustment_, random_.Motion(2.0));
  ASSERT_EQ(model.points.size(), adjustment_.points.size());
  std::size_t keypoints = 0;
  for (const SparseImage& image : model.images) keypoints += image.keypoints.size();
  EXPECT_EQ(keypoints, 4 * model.points.size());
  for (const SparsePoint& point : model.points) {
    ASSERT_EQ(point.track.size(), 4U);
    EXPECT_NEAR(point.error_px, 0.0, 1e-9);
    for (const TrackElement& element : point.track) {
      const auto image = std::find_if(model.images.begin(), model.images.end(),
                                      [&](const auto& i) { return i.ref == element.image; });
      ASSERT_NE(image, model.images.end());
      const SparseKeypoint& keypoint = image->keypoints[element.keypoint];
      EXPECT_EQ(keypoint.point_id, point.id);
      const Camera& camera = model.cameras[image->ref.eye == Eye::kLeft ? 0 : 1].camera;
      const auto pixel = Project(camera, image->camera_from_model * point.x_in_model);
      EXPECT_LT((*pixel - keypoint.pixel).norm(), 1e-9);
    }
  }
}

TEST_F(SparseOutput, TellsTheMeanErrorOfAPoint) {
  adjustment_.points[0].observations[1].pixel.x() += 2.0;
  adjustment_.points[0].observations[3].pixel.y() -= 4.0;
  const SparseModel model = MakeSparseOutput(dataset_, adjustment_, Rigid3());
  EXPECT_NEAR(model.points[0].error_px, 1.5, 1e-9);
}

TEST_F(SparseOutput, ColoursPointsByTheirFirstImage) {
  auto& second = adjustment_.points[1].observations;
  second.erase(second.begin(), second.begin() + 2);
  const SparseModel model = MakeSparseOutput(dataset_, adjustment_, random_.Motion(2.0));
  for (std::size_t i = 0; i < model.points.size(); ++i) {
    const PointObservation& first = adjustment_.points[i].observations.front();
    const auto& rgb = model.points[i].rgb;
    EXPECT_EQ(rgb[0], 2 * std::lround(first.pixel.x()));
    EXPECT_EQ(rgb[1], 3 * std::lround(first.pixel.y()));
    EXPECT_EQ(rgb[2], 50 * first.frame);
  }
}

TEST_F(SparseOutput, IsWrittenAsAModelThatReadsBack) {
  const fs::path out = folder_.Path() / "out";
  Publication publication(out, {"sparse", "sparse.ply"});
  const SparseModel model = MakeSparseOutput(dataset_, adjustment_, random_.Motion(2.0));
  PublishSparse(model, dataset_, publication);
  const SparseModel read = ReadModel(out / "sparse");
  ASSERT_EQ(read.points.size(), model.points.size());
  EXPECT_EQ(read.points[3].x_in_model, model.points[3].x_in_model);
  EXPECT_EQ(read.images[2].name, model.images[2].name);
  EXPECT_TRUE(fs::exists(out / "sparse.ply"));
  const std::string folder = folder_.Path().filename();
  EXPECT_THAT(ReadTextFile(out / "sparse" / "image_names.csv"),
              testing::StartsWith("image,original\nleft/1000.png," + folder +
                                  "/l0.PNG\nright/1000.png," + folder + "/r0.PNG\n"));
}

TEST_F(SparseOutput, ImagesAreLinkedByTheNamesOfTheModel) {
  const fs::path images = folder_.Path() / "out" / "images";
  LinkImages(dataset_, images);
  for (const SparseImage& image : MakeSparseOutput(dataset_, adjustment_, Rigid3()).images) {
    EXPECT_TRUE(fs::is_symlink(images / image.name)) << image.name;
  }
  for (const StereoFrame& frame : dataset_.frames) {
    EXPECT_TRUE(fs::equivalent(images / ImageName(frame, Eye::kRight), frame.right_path));
  }
  // Those of frames that are no longer there go.
  dataset_.frames.pop_back();
  LinkImages(dataset_, images);
  EXPECT_FALSE(fs::is_symlink(images / "left" / "1002.png"));
  EXPECT_TRUE(fs::exists(images / "left" / "1001.png"));
}

}  // namespace
}  // namespace rigmap
