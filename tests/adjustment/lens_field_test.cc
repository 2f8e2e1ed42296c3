#include "adjustment/internal/lens_field.h"

#include <gtest/gtest.h>

#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

class LensFieldTest : public testing::Test {
 protected:
  StereoRig rig_ = MakeSyntheticRover({}).rig;
};

TEST_F(LensFieldTest, IsBilinearBetweenNodesAndTellsTheEyesApart) {
  LensField field(rig_);
  const LensField::Support right = field.At(Eye::kRight, {100.0, 80.0});
  Eigen::VectorXd step = Eigen::VectorXd::Zero(field.Size());
  step(right.parameter[1]) = 0.5;
  step(right.parameter[2] + 1) = -0.25;
  field.Move(step);
  const Eigen::Vector2d moved = field.Displacement(Eye::kRight, {100.0, 80.0});
  EXPECT_DOUBLE_EQ(moved.x(), 0.5 * right.weight[1]);
  EXPECT_DOUBLE_EQ(moved.y(), -0.25 * right.weight[2]);
  EXPECT_EQ(field.Displacement(Eye::kLeft, {100.0, 80.0}), Eigen::Vector2d::Zero());
  EXPECT_GT(field.RmsPx(), 0.0);
  EXPECT_EQ(field.Of(Eye::kRight).At({100.0, 80.0}), moved);
  EXPECT_EQ(field.Of(Eye::kLeft).At({100.0, 80.0}), Eigen::Vector2d::Zero());
}

TEST_F(LensFieldTest, WeightsOfAPixelAddUpToOneUpToAndBeyondTheEdge) {
  const LensField field(rig_);
  const Camera& camera = rig_.left.camera;
  for (const double share : {-0.1, 0.0, 0.31, 0.5, 1.0, 1.1}) {
    const LensField::Support support =
        field.At(Eye::kLeft, {share * camera.width, share * camera.height});
    double sum = 0.0;
    for (int i = 0; i < 4; ++i) {
      EXPECT_GE(support.weight[i], 0.0);
      EXPECT_GE(support.parameter[i], 0);
      EXPECT_LT(support.parameter[i] + 1, field.Size());
      sum += support.weight[i];
    }
    EXPECT_NEAR(sum, 1.0, 1e-12);
  }
}

}  // namespace
}  // namespace rigmap
