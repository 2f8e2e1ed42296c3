#include "adjustment/modelled_features.h"

#include <gtest/gtest.h>

#include "adjustment/calibration.h"
#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

class AsModelledTest : public testing::Test {
 protected:
  AsModelledTest() { adjustment_.rig = LocCamRig(); }

  // In frame 1, a keypoint with a match and one without.
  FrameFeatures Moved() const {
    FrameFeatures features;
    features.features.resize(2);
    features.features[0].left = {300.0, 400.0};
    features.features[0].right = Feature::Right(250.0, 400.5);
    features.features[1].left = {700.0, 100.0};
    const FeatureSource source = [&](int frame) {
      EXPECT_EQ(frame, 1);
      return features;
    };
    return AsModelled(source, adjustment_)(1);
  }
  // By so many pixels everywhere.
  std::optional<PixelField> Shift(const Eigen::Vector2d& by) const {
    const Camera& camera = adjustment_.rig.left.camera;
    PixelField field{{2, 2, static_cast<double>(camera.width), static_cast<double>(camera.height)},
                     {}};
    field.displacements.assign(static_cast<std::size_t>(field.grid.Nodes()), by);
    return field;
  }

  Adjustment adjustment_;
};

TEST_F(AsModelledTest, NothingMovesWhereTheModelHolds) {
  EXPECT_FALSE(IsBesideModel(adjustment_));
  EXPECT_EQ(Moved().features[0].left, Eigen::Vector2d(300.0, 400.0));
  EXPECT_EQ(*Moved().features[0].right, Eigen::Vector2d(250.0, 400.5));
}

TEST_F(AsModelledTest, FieldsMoveTheirEyesPixels) {
  adjustment_.rig.left.lens_field = Shift({0.25, -0.5});
  EXPECT_TRUE(IsBesideModel(adjustment_));
  EXPECT_NEAR((Moved().features[0].left - Eigen::Vector2d(300.25, 399.5)).norm(), 0.0, 1e-9);
  EXPECT_NEAR((Moved().features[1].left - Eigen::Vector2d(700.25, 99.5)).norm(), 0.0, 1e-9);
  EXPECT_EQ(*Moved().features[0].right, Eigen::Vector2d(250.0, 400.5));
  adjustment_.rig.right.lens_field = Shift({0.125, 0.0});
  EXPECT_NEAR((*Moved().features[0].right - Eigen::Vector2d(250.125, 400.5)).norm(), 0.0, 1e-9);
  EXPECT_FALSE(Moved().features[1].right);
}

// What a right eye that has turned sees of a point is brought back to where the rig has the point.
TEST_F(AsModelledTest, TurnsOfTheFramesRightEyeAreTakenBack) {
  const Eigen::Vector3d turn(0.001, -0.002, 0.003);
  const Camera& right = adjustment_.rig.right.camera;
  const Eigen::Vector3d ray = Undistort(right, {250.0, 400.5}).value().homogeneous();
  const Eigen::Vector2d straight = Moved().features[0].right.value();
  adjustment_.right_turns = {Eigen::Vector3d::Zero(), turn};
  EXPECT_TRUE(IsBesideModel(adjustment_));
  const Eigen::Vector2d expected = *Project(right, ExpRotation(turn).inverse() * ray);
  EXPECT_GT((expected - straight).norm(), 1.0);
  EXPECT_NEAR((Moved().features[0].right.value() - expected).norm(), 0.0, 1e-6);
  EXPECT_EQ(Moved().features[0].left, Eigen::Vector2d(300.0, 400.0));
}

}  // namespace
}  // namespace rigmap
