#include "geometry/camera.h"

#include <gtest/gtest.h>

#include <ostream>
#include <string>
#include <vector>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

struct NamedCamera {
  std::string name;
  Camera camera;
};

// What stands for the parameter in a test's name.
void PrintTo(const NamedCamera& named, std::ostream* stream) { *stream << named.name; }

// Katwijk's LocCam (k1, k2), a drone's camera with tangential distortion as well (EuRoC), one with
// all that OpenCV calibrates by default, and a pinhole.
std::vector<NamedCamera> Cameras() {
  return {
      {"LocCamLeft",
       {1024, 768, 834.256002954, 838.960738733, 496.7146425, 397.7726522, -0.359945273,
        0.169265715, 0.0, 0.0}},
      {"LocCamRight",
       {1024, 768, 837.128594317, 840.816295803, 480.9380407, 390.4599725, -0.353245255,
        0.156612964, 0.0, 0.0}},
      {"EurocLeft",
       {752, 480, 458.654, 457.296, 367.215, 248.375, -0.28340811, 0.07395907, 0.00019359,
        1.76187114e-05}},
      {"EurocRight",
       {752, 480, 457.587, 456.134, 379.999, 255.238, -0.28368365, 0.07451284, -0.00010473,
        -3.555907e-05}},
      {"WithK3", {1280, 720, 700.0, 701.0, 639.0, 361.0, -0.172, 0.026, 0.0002, -0.0003, -0.004}},
      {"Pinhole", {1241, 376, 718.856, 718.856, 607.1928, 185.2157, 0.0, 0.0, 0.0, 0.0}}};
}

class CameraTest : public testing::TestWithParam<NamedCamera> {};

INSTANTIATE_TEST_SUITE_P(Rigs, CameraTest, testing::ValuesIn(Cameras()),
                         [](const auto& parameter) { return parameter.param.name; });

TEST_P(CameraTest, DistortUndoesUndistortOverTheWholeImage) {
  const Camera& camera = GetParam().camera;
  for (double v = -0.5; v <= camera.height; v += 7.25) {
    for (double u = -0.5; u <= camera.width; u += 7.25) {
      const Eigen::Vector2d pixel(u, v);
      const auto normalised = Undistort(camera, pixel);
      ASSERT_TRUE(normalised) << pixel.transpose();
      EXPECT_LT((Distort(camera, *normalised) - pixel).norm(), 1e-7) << pixel.transpose();
    }
  }
}

TEST_P(CameraTest, UndistortUndoesProject) {
  SeededRandom random;
  const Camera& camera = GetParam().camera;
  int inside = 0;
  for (int i = 0; i < 1000; ++i) {
    const double x = random.Uniform(-0.9, 0.9), y = random.Uniform(-0.6, 0.6);
    const double depth_m = random.Uniform(0.1, 50.0);
    const auto pixel = Project(camera, Eigen::Vector3d(x, y, 1.0) * depth_m);
    ASSERT_TRUE(pixel);
    if (!camera.Contains(*pixel)) continue;
    ++inside;
    const auto normalised = Undistort(camera, *pixel);
    ASSERT_TRUE(normalised);
    EXPECT_LT((*normalised - Eigen::Vector2d(x, y)).norm(), 1e-9) << x << " " << y;
  }
  EXPECT_GT(inside, 100);
}

TEST_P(CameraTest, JacobianIsTheSlopeOfDistort) {
  SeededRandom random;
  const Camera& camera = GetParam().camera;
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector2d normalised(random.Uniform(-0.8, 0.8), random.Uniform(-0.6, 0.6));
    Eigen::Matrix2d jacobian;
    EXPECT_EQ(Distort(camera, normalised, jacobian), Distort(camera, normalised));
    for (int column = 0; column < 2; ++column) {
      const Eigen::Vector2d step = kStep * Eigen::Vector2d::Unit(column);
      const Eigen::Vector2d slope =
          (Distort(camera, normalised + step) - Distort(camera, normalised - step)) / (2.0 * kStep);
      EXPECT_LT((jacobian.col(column) - slope).norm(), 1e-6 * camera.fx);
    }
  }
}

TEST_P(CameraTest, ProjectsNothingBehindOrBesideTheCamera) {
  const Camera& camera = GetParam().camera;
  EXPECT_FALSE(Project(camera, {0.1, 0.1, -1.0}));
  EXPECT_FALSE(Project(camera, {0.1, 0.1, 0.0}));
  const auto centre = Project(camera, {0.0, 0.0, 3.0});
  ASSERT_TRUE(centre);
  EXPECT_EQ(*centre, Eigen::Vector2d(camera.cx, camera.cy));
}

// x' = x (1 + k1 r2 + k2 r4 + k3 r6) + 2 p1 x y + p2 (r2 + 2 x2): OpenCV's order of coefficients.
TEST(Camera, FollowsOpenCvsModel) {
  const Camera camera{100, 100, 10.0, 20.0, 1.0, 2.0, 0.1, 0.01, 0.001, 0.002, 0.03};
  const double x = 0.5, y = 0.25, r2 = 0.3125;
  const double radial = 1.0 + 0.1 * r2 + 0.01 * r2 * r2 + 0.03 * r2 * r2 * r2;
  const double xd = x * radial + 2.0 * 0.001 * x * y + 0.002 * (r2 + 2.0 * x * x);
  const double yd = y * radial + 0.001 * (r2 + 2.0 * y * y) + 2.0 * 0.002 * x * y;
  EXPECT_LT((Distort(camera, {x, y}) - Eigen::Vector2d(10.0 * xd + 1.0, 20.0 * yd + 2.0)).norm(),
            1e-14);
}

TEST(Camera, ContainsPixelsUpToTheirOuterEdges) {
  const Camera camera{4, 3, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  EXPECT_TRUE(camera.Contains({-0.5, -0.5}));
  EXPECT_TRUE(camera.Contains({3.49, 2.49}));
  EXPECT_FALSE(camera.Contains({3.5, 1.0}));
  EXPECT_FALSE(camera.Contains({1.0, 2.5}));
}

// r (1 - 0.3 r2) rises to 0.703 at r = 1.054, then falls and turns negative: rays beyond must not
// come back into the image, pixels beyond have no ray.
TEST(Camera, HasNothingBeyondTheFoldOfItsDistortion) {
  const Camera camera{1000, 1000, 500.0, 500.0, 500.0, 500.0, -0.3, 0.0, 0.0, 0.0};
  EXPECT_TRUE(Project(camera, {1.05, 0.0, 1.0}));
  for (const double x : {1.06, 1.5, 1.8, 2.0, 3.0}) {
    EXPECT_FALSE(Project(camera, {x, 0.0, 1.0})) << x;
    EXPECT_FALSE(Project(camera, {-x, 0.5, 1.0})) << x;
  }
  EXPECT_TRUE(Undistort(camera, {500.0 + 500.0 * 0.70, 500.0}));
  for (double radius = 0.704; radius < 3.0; radius += 0.01) {
    EXPECT_FALSE(Undistort(camera, {500.0 + 500.0 * radius, 500.0})) << radius;
    EXPECT_FALSE(Undistort(camera, {500.0, 500.0 - 500.0 * radius})) << radius;
  }
}

// r (1 + 0.2 r2 - 0.1 r6) rises until 1 + 0.6 r2 = 0.7 r6, at r = 1.173.
TEST(Camera, HasNothingBeyondAFoldOfK3) {
  const Camera camera{1000, 1000, 500.0, 500.0, 500.0, 500.0, 0.2, 0.0, 0.0, 0.0, -0.1};
  for (const double x : {0.5, 1.0, 1.17}) EXPECT_TRUE(Project(camera, {x, 0.0, 1.0})) << x;
  for (const double x : {1.18, 1.5, 2.0, 4.0}) EXPECT_FALSE(Project(camera, {x, 0.0, 1.0})) << x;
}

// Each polynomial of the growth against one that is looked at step by step from the axis.
TEST(Camera, FoldIsWhereTheGrowthFirstEnds) {
  SeededRandom random;
  int folded = 0;
  for (int i = 0; i < 2000; ++i) {
    Camera camera{1000, 1000, 500.0, 500.0, 500.0, 500.0};
    camera.k1 = random.Uniform(-1.0, 1.0);
    camera.k2 = i % 3 == 0 ? 0.0 : random.Uniform(-1.0, 1.0);
    camera.k3 = i % 2 == 0 ? 0.0 : random.Uniform(-1.0, 1.0);
    const double radius = random.Uniform(0.0, 2.0);
    double least = 1.0;
    for (double r = 0.0; r <= radius; r += 0.001) {
      const double r2 = r * r;
      least = std::min(least, 1.0 + 3.0 * camera.k1 * r2 + 5.0 * camera.k2 * r2 * r2 +
                                  7.0 * camera.k3 * r2 * r2 * r2);
    }
    if (std::abs(least) < 0.02) continue;  // between two steps
    folded += least < 0.0;
    EXPECT_EQ(IsInsideFold(camera, {0.6 * radius, 0.8 * radius}), least > 0.0) << i;
  }
  EXPECT_GT(folded, 200);
}

// Where the polynomial rises again, as r (1 - 0.5 r2 + 0.1 r4) does from r = 1.41, rays beyond the
// first fold (r = 1) stay excluded.
TEST(Camera, HasNothingOnTheOuterBranchOfItsDistortion) {
  const Camera camera{1000, 1000, 500.0, 500.0, 500.0, 500.0, -0.5, 0.1, 0.0, 0.0};
  EXPECT_TRUE(Project(camera, {0.99, 0.0, 1.0}));
  for (const double x : {1.01, 1.3, 1.5, 1.7, 2.5}) {
    EXPECT_FALSE(Project(camera, {x, 0.0, 1.0})) << x;
  }
  for (double radius = 0.61; radius < 3.0; radius += 0.01) {
    EXPECT_FALSE(Undistort(camera, {500.0, 500.0 - 500.0 * radius})) << radius;
  }
}

}  // namespace
}  // namespace rigmap
