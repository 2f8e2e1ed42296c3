#include "report/map_views.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rigmap {
namespace {

constexpr double kHeight_m = 2.0, kFocal_px = 400.0;
// Looks straight down at squares of 2 x 2 m, a metre further along x each time.
Trajectory Flight(int poses) {
  Trajectory trajectory;
  for (int i = 0; i < poses; ++i) {
    TimedPose pose{.stamp_ns = i};
    pose.source = PoseSource::kAdjusted;
    pose.world_from_left = {
        Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX())),
        Eigen::Vector3d(1.0 * i, 0.0, kHeight_m)};
    trajectory.push_back(pose);
  }
  return trajectory;
}

Camera Down() {
  return {.width = 400, .height = 400, .fx = kFocal_px, .fy = kFocal_px, .cx = 199.5, .cy = 199.5};
}

// Level ground from -1 to `to_m` along x, 2 m wide.
PointCloud Ground(double to_m) {
  PointCloud cloud;
  for (double x = -0.975; x < to_m; x += 0.05) {
    for (double y = -0.975; y < 1.0; y += 0.05) {
      SurfacePoint point;
      point.x_in_world = Eigen::Vector3d(x, y, 0.0).cast<float>();
      cloud.push_back(point);
    }
  }
  return cloud;
}

int ImagesAt(const MapViews& views, double x, double y) {
  const int column = static_cast<int>((x - views.low_m.x()) / views.cell_m);
  const int row = static_cast<int>((y - views.low_m.y()) / views.cell_m);
  return views.images[static_cast<std::size_t>(row * views.columns + column)];
}

TEST(ViewsOf, CountsTheImagesThatShowASpot) {
  const MapViews views = ViewsOf(Ground(5.0), Down(), Flight(5)).value();
  EXPECT_EQ(ImagesAt(views, -0.5, 0.0), 1);
  EXPECT_EQ(ImagesAt(views, 2.5, 0.5), 2);
  EXPECT_EQ(ImagesAt(views, 4.5, -0.5), 1);
  EXPECT_EQ(views.median_images, 2.0);
  EXPECT_EQ(views.heights_m.size(), views.images.size());
  EXPECT_EQ(std::ranges::count_if(views.heights_m, [](double z) { return std::abs(z) < 1e-6; }),
            std::ranges::count_if(views.images, [](int images) { return images > 0; }));
  EXPECT_NEAR(views.median_pixel_m, kHeight_m / kFocal_px, 1e-6);
}

TEST(ViewsOf, LeavesOutGuessedPosesAndEmptySpots) {
  Trajectory trajectory = Flight(2);
  trajectory[1].source = PoseSource::kPredicted;
  const MapViews views = ViewsOf(Ground(5.0), Down(), trajectory).value();
  EXPECT_EQ(ImagesAt(views, 0.5, 0.0), 1);
  EXPECT_EQ(ImagesAt(views, 3.0, 0.0), 0);
  EXPECT_FALSE(ViewsOf({}, Down(), trajectory));
  trajectory[0].source = PoseSource::kPredicted;
  EXPECT_FALSE(ViewsOf(Ground(5.0), Down(), trajectory));
}

// One camera at the far end sees all the way along the row that the others look down upon.
TEST(ViewsOf, ALookAtTheHorizonIsNoViewOfWhatOthersSeeNear) {
  Trajectory trajectory = Flight(31);
  TimedPose ahead{.stamp_ns = 100};
  ahead.source = PoseSource::kAdjusted;
  Eigen::Matrix3d axes;  // looks along x, its right towards -y
  axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  ahead.world_from_left = {Eigen::Quaterniond(axes), Eigen::Vector3d(-4.0, 0.0, 1.0)};
  trajectory.push_back(ahead);
  const MapViews views = ViewsOf(Ground(31.0), Down(), trajectory).value();
  EXPECT_EQ(ImagesAt(views, 20.5, 0.0), 2);
}

}  // namespace
}  // namespace rigmap
