#include "scale/free_camera_poses.h"

#include <gmock/gmock.h>

#include "tests/support/rover_correspondences.h"

namespace rigmap {
namespace {

// Four frames of a synthetic rover as a model of free cameras, a quarter as large as the world.
class FreeCameraPoses : public testing::Test {
 protected:
  FreeCameraPoses() : rover_(MakeSyntheticRover()) {
    for (int i = 0; i < 4; ++i) {
      const Rigid3& left = rover_.world_from_left[i];
      Add({i, Eye::kLeft}, left);
      Add({i, Eye::kRight}, left * rover_.rig.right_from_left.Inverse());
    }
  }

  void Add(const ImageRef& ref, Rigid3 world_from_camera) {
    world_from_camera.translation *= 0.25;
    model_.images.push_back({.ref = ref, .camera_from_model = world_from_camera.Inverse()});
  }

  AlignedKeyframes Pose() const { return PoseFreeCameras({model_}, 6, rover_.rig, ScaleOptions()); }

  void ExpectTruth(const AlignedKeyframes& found, double tolerance_m) const {
    for (int i = 0; i < 4; ++i) {
      ASSERT_TRUE(found.world_from_left[i]) << i;
      const Rigid3 expected = rover_.world_from_left[0].Inverse() * rover_.world_from_left[i];
      const Rigid3 off = found.world_from_left[i]->Inverse() * expected;
      EXPECT_LT(off.translation.norm(), tolerance_m) << i;
    }
  }

  SyntheticRover rover_;
  SparseModel model_;
};

TEST_F(FreeCameraPoses, AreInMetres) {
  const AlignedKeyframes found = Pose();
  ExpectTruth(found, 1e-9);
  EXPECT_FALSE(found.world_from_left[4] || found.world_from_left[5]);
  ASSERT_EQ(found.models.size(), 1U);
  EXPECT_NEAR(found.models.front().scale.metres_per_model_unit, 4.0, 1e-9);
  EXPECT_THAT(found.models.front().keyframes, testing::ElementsAre(0, 1, 2, 3));
}

TEST_F(FreeCameraPoses, FollowTheOneCameraThatWasRegistered) {
  model_.images.erase(model_.images.begin() + 4);  // left of frame 2
  ExpectTruth(Pose(), 1e-9);
}

TEST_F(FreeCameraPoses, StandAtTheMidpoint) {
  // Each camera of frame 3 off by 2 mm across, to opposite sides: the midpoint does not move.
  for (const std::size_t image : {6U, 7U}) {
    Rigid3 model_from_camera = model_.images[image].camera_from_model.Inverse();
    const double aside = image == 6U ? 0.0005 : -0.0005;
    model_from_camera.translation += model_from_camera.rotation * Eigen::Vector3d(0, aside, 0);
    model_.images[image].camera_from_model = model_from_camera.Inverse();
  }
  ExpectTruth(Pose(), 2e-4);
}

TEST_F(FreeCameraPoses, TellHowFarFocalLengthsWereChanged) {
  EXPECT_EQ(FocalLengthChange(model_, rover_.rig), 0.0);
  model_.cameras = {{Eye::kLeft, rover_.rig.left.camera}, {Eye::kRight, rover_.rig.right.camera}};
  EXPECT_EQ(FocalLengthChange(model_, rover_.rig), 0.0);
  model_.cameras[0].camera.fx *= 1.01;
  model_.cameras[1].camera.fy *= 0.96;
  EXPECT_NEAR(FocalLengthChange(model_, rover_.rig), 1.0 / 0.96 - 1.0, 1e-9);
  model_.cameras[0].camera.fx = 0.5 * rover_.rig.left.camera.fx;
  EXPECT_NEAR(FocalLengthChange(model_, rover_.rig), 1.0, 1e-9);
}

// Points before frame 0 as both of its eyes see them.
void AddPoints(const StereoRig& rig, const Rigid3& model_from_left, double metres_per_model_unit,
               SparseModel& model) {
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector3d x(0.1 * (i % 5) - 0.2, 0.1 * (i % 3), 1.5 + 0.1 * i);
    SparsePoint point{.x_in_model = model_from_left * (x / metres_per_model_unit)};
    for (const Eye eye : kEyes) {
      SparseImage& image = model.images[eye == Eye::kLeft ? 0 : 1];
      const Eigen::Vector3d seen = eye == Eye::kLeft ? x : rig.right_from_left * x;
      point.track.push_back({image.ref, static_cast<std::uint32_t>(image.keypoints.size())});
      image.keypoints.push_back({.pixel = Distort(rig.Of(eye).camera, seen.hnormalized())});
    }
    model.points.push_back(point);
  }
}

TEST_F(FreeCameraPoses, TellHowFarDepthsDifferFromTheRigs) {
  EXPECT_FALSE(DepthChange(model_, 4.0, rover_.rig));
  const Rigid3 model_from_left = model_.images[0].camera_from_model.Inverse();
  AddPoints(rover_.rig, model_from_left, 4.0, model_);
  ASSERT_TRUE(DepthChange(model_, 4.0, rover_.rig));
  EXPECT_NEAR(*DepthChange(model_, 4.0, rover_.rig), 0.0, 1e-6);
  // The same left-right distance, but another scale.
  EXPECT_NEAR(*DepthChange(model_, 4.4, rover_.rig), 0.1, 1e-6);
  for (SparsePoint& point : model_.points) point.track.pop_back();
  EXPECT_FALSE(DepthChange(model_, 4.0, rover_.rig));
}

TEST_F(FreeCameraPoses, AreNoneWithoutAStereoPair) {
  model_.images.resize(1);
  const AlignedKeyframes found = Pose();
  EXPECT_TRUE(found.models.empty());
  EXPECT_EQ(found.world_from_left.size(), 6U);
}

}  // namespace
}  // namespace rigmap
