#include "imaging/disparity_normal.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "geometry/rigid3.h"
#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

constexpr int kRow = 30, kColumn = 40;

// A plane through a point on the axis, as disparities.
DepthMap PlaneSeen(const Eigen::Vector3d& normal, double depth_m) {
  DepthMap map;
  map.camera = {80, 60, 100.0, 110.0, 40.0, 30.0};
  map.baseline_m = 0.12;
  map.disparity = cv::Mat(60, 80, CV_32FC1, cv::Scalar(0.0));
  const double fb = map.camera.fx * map.baseline_m;
  for (int row = 0; row < 60; ++row) {
    for (int column = 0; column < 80; ++column) {
      const Eigen::Vector3d ray((column - map.camera.cx) / map.camera.fx,
                                (row - map.camera.cy) / map.camera.fy, 1.0);
      map.disparity.at<float>(row, column) =
          static_cast<float>(fb * normal.dot(ray) / (normal.z() * depth_m));
    }
  }
  return map;
}

TEST(NormalInRectified, IsThatOfAnyPlaneTowardsTheCamera) {
  SeededRandom random;
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector3d normal =
        ExpRotation(random.Vector(0.6)) * Eigen::Vector3d(0.0, 0.0, -1.0);
    const Eigen::Vector3d found = NormalInRectified(PlaneSeen(normal, 3.0), kRow, kColumn);
    EXPECT_LT((found - normal).norm(), 1e-4) << i;
  }
}

TEST(NormalsInRectified, AreThoseOfTheKnownPixels) {
  DepthMap map = PlaneSeen({0.0, 0.0, -1.0}, 3.0);
  map.disparity.at<float>(kRow, kColumn) = 0.0F;
  const cv::Mat normals = NormalsInRectified(map);
  ASSERT_EQ(normals.type(), CV_32FC3);
  ASSERT_EQ(normals.size(), map.disparity.size());
  EXPECT_EQ(normals.at<cv::Vec3f>(kRow, kColumn), cv::Vec3f(0.0F, 0.0F, 0.0F));
  EXPECT_LT(cv::norm(normals.at<cv::Vec3f>(4, 4) - cv::Vec3f(0.0F, 0.0F, -1.0F)), 1e-4);
  EXPECT_LT(cv::norm(normals.at<cv::Vec3f>(kRow, kColumn + 1) - cv::Vec3f(0.0F, 0.0F, -1.0F)),
            1e-4);
}

TEST(NormalInRectified, PassesOverAnotherSurfaceInTheWindow) {
  const Eigen::Vector3d normal = Eigen::Vector3d(0.1, -0.3, -1.0).normalized();
  DepthMap map = PlaneSeen(normal, 3.0);
  map.disparity.colRange(kColumn + 2, 80) += 10.0;
  EXPECT_LT((NormalInRectified(map, kRow, kColumn) - normal).norm(), 1e-4);
}

TEST(NormalInRectified, IsZeroWhereTooLittleIsKnown) {
  DepthMap map = PlaneSeen({0.0, 0.0, -1.0}, 3.0);
  map.disparity.setTo(0.0);
  map.disparity.at<float>(kRow, kColumn) = 4.0F;
  EXPECT_EQ(NormalInRectified(map, kRow, kColumn), Eigen::Vector3d::Zero());
  // Nine pixels of the grid of every second one, one too few.
  map.disparity(cv::Rect(kColumn - 2, kRow - 2, 5, 5)).setTo(4.0);
  EXPECT_EQ(NormalInRectified(map, kRow, kColumn), Eigen::Vector3d::Zero());
  map.disparity.at<float>(kRow + 4, kColumn) = 4.0F;
  EXPECT_LT((NormalInRectified(map, kRow, kColumn) + Eigen::Vector3d::UnitZ()).norm(), 1e-9);
}

TEST(NormalInRectified, StaysWithinTheImage) {
  const DepthMap map = PlaneSeen({0.0, 0.0, -1.0}, 3.0);
  for (const int row : {0, 59}) {
    for (const int column : {0, 79}) {
      const Eigen::Vector3d normal = NormalInRectified(map, row, column);
      if (normal.isZero()) continue;
      EXPECT_LT((normal + Eigen::Vector3d::UnitZ()).norm(), 1e-5);
    }
  }
}

TEST(LiesOnPlane, SaysSoOfLevelGroundFarAway) {
  // Seen at 81 degrees from its normal; the image reaches no nearer to the horizon.
  DepthMap map = PlaneSeen(Eigen::Vector3d(0.02, -1.0, -0.15).normalized(), 3.0);
  EXPECT_TRUE(LiesOnPlane(map, kRow, kColumn));
  SeededRandom random;
  for (int row = 0; row < 60; ++row) {
    for (int column = 0; column < 80; ++column) {
      map.disparity.at<float>(row, column) += static_cast<float>(random.Normal(0.15));
    }
  }
  EXPECT_TRUE(LiesOnPlane(map, kRow, kColumn));
}

// As matching leads from one side to the other.
TEST(LiesOnPlane, DoesNotSayItOfAStepOfTheDepth) {
  for (const float step_px : {2.0F, 4.0F, 20.0F}) {
    DepthMap map = PlaneSeen({0.0, 0.0, -1.0}, 1.0);
    for (int column = 0; column < 80; ++column) {
      const float share = std::clamp(static_cast<float>(column - kColumn + 4) / 8.0F, 0.0F, 1.0F);
      map.disparity.col(column) += step_px * share;
    }
    EXPECT_FALSE(LiesOnPlane(map, kRow, kColumn)) << step_px;
  }
}

TEST(LiesOnPlane, DoesNotSayItWhereTooLittleIsKnown) {
  DepthMap map = PlaneSeen({0.0, 0.0, -1.0}, 3.0);
  map.disparity.colRange(0, kColumn - 2).setTo(0.0);
  EXPECT_FALSE(LiesOnPlane(map, kRow, kColumn));
}

}  // namespace
}  // namespace rigmap
