#include "adjustment/reprojection.h"

#include <gtest/gtest.h>

#include <functional>

#include "adjustment/calibration.h"
#include "tests/support/seeded_random.h"
#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

// A point that both eyes see, from a pose.
struct Scene {
  StereoRig rig;
  Rigid3 left_from_world;
  Eigen::Vector3d x;
};

Scene MakeScene(SeededRandom& random) {
  Scene scene{LocCamRig(), random.Motion(10.0), {}};
  for (RigEye* eye : {&scene.rig.left, &scene.rig.right}) {
    eye->camera.p1 = random.Uniform(-0.002, 0.002);
    eye->camera.p2 = random.Uniform(-0.002, 0.002);
  }
  const double depth_m = random.Uniform(1.0, 20.0);
  const Eigen::Vector3d in_left(random.Uniform(-0.4, 0.4) * depth_m,
                                random.Uniform(-0.3, 0.3) * depth_m, depth_m);
  scene.x = scene.left_from_world.Inverse() * in_left;
  return scene;
}

Reprojection At(const Scene& scene, Eye eye) {
  return Reproject(scene.rig, eye, scene.left_from_world, scene.x).value();
}

using Change = std::function<void(Scene&, int axis, double step)>;

// d(pixel) by the change along each axis, from central differences.
Eigen::Matrix2Xd Numeric(const Scene& scene, Eye eye, int axes, const Change& change) {
  constexpr double kStep = 1e-6;
  Eigen::Matrix2Xd jacobian(2, axes);
  for (int axis = 0; axis < axes; ++axis) {
    Scene ahead = scene, behind = scene;
    change(ahead, axis, kStep);
    change(behind, axis, -kStep);
    jacobian.col(axis) = (At(ahead, eye).pixel - At(behind, eye).pixel) / (2.0 * kStep);
  }
  return jacobian;
}

void CorrectOne(Scene& scene, int parameter, double step) {
  scene.rig = Corrected(scene.rig, step * CalibrationVector::Unit(parameter));
}

class ReprojectionTest : public testing::TestWithParam<Eye> {
 protected:
  void ExpectJacobian(const Eigen::Matrix2Xd& found, const Eigen::Matrix2Xd& numeric) {
    const double largest = std::max(1.0, numeric.cwiseAbs().maxCoeff());  // px per unit
    EXPECT_LT((found - numeric).cwiseAbs().maxCoeff(), 1e-5 * largest) << found << "\nexpected\n"
                                                                       << numeric;
  }

  SeededRandom random_;
};

TEST_P(ReprojectionTest, IsTheProjectionIntoTheEye) {
  for (int trial = 0; trial < 50; ++trial) {
    const Scene scene = MakeScene(random_);
    const Rigid3 eye_from_left = GetParam() == Eye::kLeft ? Rigid3() : scene.rig.right_from_left;
    const auto pixel =
        Project(scene.rig.Of(GetParam()).camera, eye_from_left * scene.left_from_world * scene.x);
    ASSERT_TRUE(pixel);
    EXPECT_LT((At(scene, GetParam()).pixel - *pixel).norm(), 1e-9);  // px
  }
}

TEST_P(ReprojectionTest, PoseJacobianIsThatOfDifferences) {
  for (int trial = 0; trial < 50; ++trial) {
    const Scene scene = MakeScene(random_);
    const Change change = [](Scene& s, int axis, double step) {
      if (axis >= 3) {
        s.left_from_world.translation(axis - 3) += step;
        return;
      }
      const Eigen::Quaterniond turn = ExpRotation(step * Eigen::Vector3d::Unit(axis));
      s.left_from_world.rotation = turn * s.left_from_world.rotation;
    };
    ExpectJacobian(At(scene, GetParam()).jacobians.pose, Numeric(scene, GetParam(), 6, change));
  }
}

TEST_P(ReprojectionTest, PointJacobianIsThatOfDifferences) {
  for (int trial = 0; trial < 50; ++trial) {
    const Scene scene = MakeScene(random_);
    const Change change = [](Scene& s, int axis, double step) { s.x(axis) += step; };
    ExpectJacobian(At(scene, GetParam()).jacobians.point, Numeric(scene, GetParam(), 3, change));
  }
}

TEST_P(ReprojectionTest, CalibrationJacobianIsThatOfCorrections) {
  for (int trial = 0; trial < 50; ++trial) {
    const Scene scene = MakeScene(random_);
    const auto& found = At(scene, GetParam()).jacobians.calibration;
    ExpectJacobian(found, Numeric(scene, GetParam(), kCalibrationSize, CorrectOne));
    EXPECT_EQ(found.middleCols<3>(kRotationX).isZero(0.0), GetParam() == Eye::kLeft);
  }
}

TEST_P(ReprojectionTest, DoesNotDependOnTheWorld) {
  for (int trial = 0; trial < 50; ++trial) {
    const Scene scene = MakeScene(random_);
    const Rigid3 other_from_world = random_.Motion(10.0);
    Scene moved = scene;
    moved.x = other_from_world * scene.x;
    moved.left_from_world = scene.left_from_world * other_from_world.Inverse();
    EXPECT_LT((At(moved, GetParam()).pixel - At(scene, GetParam()).pixel).norm(), 1e-8);  // px
  }
}

TEST_P(ReprojectionTest, NothingBehindTheEye) {
  Scene scene = MakeScene(random_);
  const Eigen::Vector3d in_left = scene.left_from_world * scene.x;
  scene.x = scene.left_from_world.Inverse() * Eigen::Vector3d(-in_left);
  EXPECT_FALSE(Reproject(scene.rig, GetParam(), scene.left_from_world, scene.x));
}

TEST_P(ReprojectionTest, ForManyPointsOfAFrameIsTheSame) {
  for (int trial = 0; trial < 50; ++trial) {
    const Scene scene = MakeScene(random_);
    const Reprojection expected = At(scene, GetParam());
    const FrameProjection frame(scene.rig, scene.left_from_world);
    const auto found = frame.Linearise(GetParam(), scene.x);
    ASSERT_TRUE(found);
    EXPECT_LT((found->pixel - expected.pixel).norm(), 1e-9);
    EXPECT_LT((*frame.Project(GetParam(), scene.x) - expected.pixel).norm(), 1e-9);
    EXPECT_TRUE(found->by_pose.isApprox(expected.jacobians.pose, 1e-9));
    EXPECT_TRUE(found->by_point.isApprox(expected.jacobians.point, 1e-9));
    const Eigen::Vector3d behind = scene.left_from_world.Inverse() * Eigen::Vector3d(0, 0, -1);
    EXPECT_FALSE(frame.Project(GetParam(), behind));
    EXPECT_FALSE(frame.Linearise(GetParam(), behind));
  }
}

INSTANTIATE_TEST_SUITE_P(Eyes, ReprojectionTest, testing::Values(Eye::kLeft, Eye::kRight),
                         [](const auto& eye) {
                           return eye.param == Eye::kLeft ? "Left" : "Right";
                         });

TEST(RigRotation, TurnsAboutTheRightCentreWhichStays) {
  SeededRandom random;
  for (int trial = 0; trial < 20; ++trial) {
    Scene scene = MakeScene(random);
    const Eigen::Vector3d centre_in_left = scene.rig.right_from_left.Inverse().translation;
    CorrectOne(scene, kRotationX + trial % 3, 0.1);
    const Eigen::Vector3d after = scene.rig.right_from_left.Inverse().translation;
    EXPECT_LT((after - centre_in_left).norm(), 1e-15);  // m
    // Points in line with that centre move alike, however far they are.
    const Eigen::Vector3d along = scene.left_from_world * scene.x - centre_in_left;
    Scene near = scene, far = scene;
    near.x = scene.left_from_world.Inverse() * (centre_in_left + along).eval();
    far.x = scene.left_from_world.Inverse() * (centre_in_left + 7.0 * along).eval();
    const auto of_near = At(near, Eye::kRight), of_far = At(far, Eye::kRight);
    EXPECT_LT((of_near.pixel - of_far.pixel).norm(), 1e-8);  // px
    const Eigen::MatrixXd difference = of_near.jacobians.calibration - of_far.jacobians.calibration;
    EXPECT_LT(difference.leftCols(3).norm(), 1e-6);
  }
}

}  // namespace
}  // namespace rigmap
