#include "raster/surface_views.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <random>

#include "core/error.h"
#include "raster/internal/picture_frame.h"
#include "raster/internal/view_axes.h"
#include "tests/raster/synthetic_map.h"
#include "tests/support/message_of.h"
#include "tests/support/seeded_random.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

using testing::HasSubstr;
using testing::UnorderedElementsAre;

constexpr double kViewCell = 0.01;  // m

Trajectory Path(const std::vector<Eigen::Vector3d>& positions) {
  Trajectory trajectory;
  for (const Eigen::Vector3d& position : positions) {
    TimedPose pose;
    pose.stamp_ns = static_cast<StampNs>(trajectory.size());
    pose.world_from_left.translation = position;
    trajectory.push_back(pose);
  }
  return trajectory;
}

Trajectory PathAlongX() { return Path({{-0.5, 0.0, 0.0}, {0.5, 0.0, 0.0}, {1.5, 0.0, 0.0}}); }

bool Alike(const cv::Vec3b& pixel, const cv::Scalar& bgr) {
  return std::abs(pixel[0] - bgr[0]) + std::abs(pixel[1] - bgr[1]) + std::abs(pixel[2] - bgr[2]) <
         6.0;
}

bool Bluish(const cv::Vec3b& pixel) { return pixel[0] > pixel[2] + 60; }

// The mean place of the pixels above the footer that fulfil a condition, and their number.
struct Patch {
  Eigen::Vector2d centre_px = Eigen::Vector2d::Zero();
  int count = 0;
};
template <class Condition>
Patch Find(const cv::Mat3b& picture, Condition condition) {
  Patch patch;
  for (int row = 0; row < picture.rows - kFooterPx; ++row) {
    for (int column = 0; column < picture.cols; ++column) {
      if (!condition(picture(row, column))) continue;
      patch.centre_px += Eigen::Vector2d(column, row);
      ++patch.count;
    }
  }
  if (patch.count > 0) patch.centre_px /= patch.count;
  return patch;
}

// Length of the scale bar as drawn: the dark run on its upper rim.
int BarPx(const cv::Mat3b& picture) {
  int longest = 0;
  for (int row = picture.rows - kFooterPx - kMarginPx; row < picture.rows; ++row) {
    int run = 0;
    for (int column = 0; column < picture.cols; ++column) {
      run = Alike(picture(row, column), {40, 40, 40}) ? run + 1 : 0;
      longest = std::max(longest, run);
    }
  }
  return longest;
}

class Views : public testing::Test {
 protected:
  void Write(const PointCloud& cloud, const Trajectory& trajectory,
             const std::string& warning = {}) {
    WriteSurfaceViews({WriteCloud(folder_.Path() / "dense.ply", cloud), kViewCell, warning},
                      trajectory, folder_.Path(), options_);
  }
  cv::Mat3b Picture(const std::string& name) {
    return cv::imread((folder_.Path() / name).string(), cv::IMREAD_COLOR);
  }

  TemporaryFolder folder_;
  PictureOptions options_{.picture_px = 1000};
};

bool IsRed(const cv::Vec3b& pixel) { return pixel[2] > 150 && pixel[0] < 60 && pixel[1] < 60; }

TEST_F(Views, BearAWarningInTheirMarginsOnly) {
  const PointCloud cloud = MapCloud(kViewCell);
  Write(cloud, PathAlongX());
  for (const char* name : {"view_top.png", "view_side.png", "view_oblique.png"}) {
    const cv::Mat3b before = Picture(name);
    EXPECT_FALSE(IsRed(before(4, before.cols / 2))) << name;
  }
  const cv::Mat3b trusted = Picture("view_top.png");
  Write(cloud, PathAlongX(), "not trusted: scale known to 1.2 %, asked 1 %");
  for (const char* name : {"view_top.png", "view_side.png", "view_oblique.png"}) {
    const cv::Mat3b picture = Picture(name);
    EXPECT_TRUE(IsRed(picture(4, picture.cols / 2))) << name;
    EXPECT_TRUE(IsRed(picture(picture.rows / 2, 2))) << name;
    EXPECT_TRUE(IsRed(picture(picture.rows - 3, picture.cols - 3))) << name;
  }
  // The words are white on the band.
  const cv::Mat3b picture = Picture("view_top.png");
  const cv::Mat3b band = picture(cv::Rect(0, 0, picture.cols, kMarginPx));
  int white = 0;
  for (const cv::Vec3b& pixel : cv::Mat3b(band.clone())) white += pixel == cv::Vec3b(255, 255, 255);
  EXPECT_GT(white, 500);
  ASSERT_EQ(picture.size(), trusted.size());
  const cv::Rect inside(kMarginPx, kMarginPx, picture.cols - 2 * kMarginPx,
                        picture.rows - 2 * kMarginPx);
  EXPECT_EQ(cv::norm(picture(inside), trusted(inside), cv::NORM_INF), 0.0);
  // However long the words, they stay inside.
  Write(cloud, PathAlongX(), "not trusted: " + std::string(300, 'w'));
  EXPECT_TRUE(IsRed(Picture("view_top.png")(16, picture.cols - 8)));
}

TEST(ScaleBar, IsTheLongestRoundLengthThatFits) {
  EXPECT_DOUBLE_EQ(ScaleBarLength(1.0), 1.0);
  EXPECT_DOUBLE_EQ(ScaleBarLength(0.999), 0.5);
  EXPECT_DOUBLE_EQ(ScaleBarLength(4.99), 2.0);
  EXPECT_DOUBLE_EQ(ScaleBarLength(70.0), 50.0);
  EXPECT_DOUBLE_EQ(ScaleBarLength(0.024), 0.02);
  SeededRandom random;
  for (int i = 0; i < 1000; ++i) {
    const double max_m = std::pow(10.0, random.Uniform(-3.0, 4.0));
    const double length_m = ScaleBarLength(max_m);
    EXPECT_LE(length_m, max_m * (1.0 + 1e-9));
    EXPECT_GT(length_m, max_m / 2.5 * (1.0 - 1e-9));
  }
  EXPECT_EQ(ScaleBarLabel(0.5), "0.5 m");
  EXPECT_EQ(ScaleBarLabel(ScaleBarLength(30.0)), "20 m");
}

TEST(ViewAxes, AreRightHandedAndLookWhereTheyShould) {
  SeededRandom random;
  for (int i = 0; i < 100; ++i) {
    const double heading_rad = random.Uniform(-3.1, 3.1);
    const Eigen::Vector3d driving(std::cos(heading_rad), std::sin(heading_rad), 0.0);
    for (const ViewAxes& axes : {TopView(), SideView(driving), ObliqueView(driving)}) {
      EXPECT_LT((axes.right.cross(axes.up) - axes.towards_viewer).norm(), 1e-12);
      EXPECT_NEAR(axes.right.norm(), 1.0, 1e-12);
      EXPECT_NEAR(axes.right.z(), 0.0, 1e-12);
    }
    EXPECT_LT((SideView(driving).right - driving).norm(), 1e-12);
    EXPECT_GT(ObliqueView(driving).towards_viewer.z(), 0.5);            // from above
    EXPECT_LT(ObliqueView(driving).towards_viewer.dot(driving), -0.4);  // from behind
  }
}

TEST(DrivingDirection, FollowsThePathFromStartToEnd) {
  SeededRandom random;
  for (int i = 0; i < 100; ++i) {
    const double heading_rad = random.Uniform(-3.1, 3.1);
    const Eigen::Vector3d driving(std::cos(heading_rad), std::sin(heading_rad), 0.0);
    std::vector<Eigen::Vector3d> positions;
    for (int k = 0; k < 20; ++k) positions.push_back(0.3 * k * driving + random.Noise(0.02));
    EXPECT_GT(DrivingDirection(Path(positions)).dot(driving), 0.999);
  }
  EXPECT_EQ(DrivingDirection({}), Eigen::Vector3d::UnitX());
  EXPECT_EQ(DrivingDirection(Path({{1.0, 2.0, 3.0}})), Eigen::Vector3d::UnitX());
  const Trajectory loop = Path({{0, 0, 0}, {5, 1, 0}, {10, 0, 0}, {5, -1, 0}, {0, 0, 0}});
  EXPECT_GT(DrivingDirection(loop).x(), 0.99);
}

TEST(RangeCounter, LeavesOutStraysOnly) {
  RangeCounter counter;
  for (int i = 0; i < 10000; ++i) counter.Add(0.001 * i);
  counter.Add(-1000.0);
  counter.Add(1e30);
  EXPECT_LT(counter.Trimmed(0.0).low, -999.0);
  const RangeCounter::Range range = counter.Trimmed(0.0002);
  EXPECT_NEAR(range.low, 0.0, 0.05);  // m
  EXPECT_NEAR(range.high, 10.0, 0.05);
}

TEST_F(Views, HaveTheSizeAskedForWithPathAndScale) {
  Write(MapCloud(kViewCell), PathAlongX());
  EXPECT_THAT(NamesIn(folder_.Path()), UnorderedElementsAre("dense.ply", "view_top.png",
                                                            "view_side.png", "view_oblique.png"));
  for (const std::string name : {"view_top.png", "view_side.png", "view_oblique.png"}) {
    const cv::Mat3b picture = Picture(name);
    ASSERT_FALSE(picture.empty()) << name;
    EXPECT_NEAR(std::max(picture.cols, picture.rows), 1000, 2) << name;
    const auto path = [](const cv::Vec3b& pixel) { return Alike(pixel, kPathColour); };
    EXPECT_GT(Find(picture, path).count, 500) << name;
    const auto start = [](const cv::Vec3b& pixel) { return Alike(pixel, kStartColour); };
    EXPECT_GT(Find(picture, start).count, 50) << name;
    EXPECT_GT(Find(picture, Bluish).count, 100) << name;
    EXPECT_TRUE(Alike(picture(2, 2), kBackgroundColour)) << name;
  }
}

TEST_F(Views, ShowPositionsWhereTheScaleSaysTheyAre) {
  Write(MapCloud(kViewCell), PathAlongX());
  const cv::Mat3b picture = Picture("view_top.png");
  // The cloud is 4 m wide (and up to a step of 5 cm at either end), so a quarter takes 1 m.
  const double px_per_m = BarPx(picture) / 1.0;
  EXPECT_NEAR(px_per_m, (1000.0 - 2 * kMarginPx) / 4.05, 5.0);
  const auto start = [](const cv::Vec3b& pixel) { return Alike(pixel, kStartColour); };
  const Eigen::Vector2d start_px = Find(picture, start).centre_px;
  const Eigen::Vector2d box_px = Find(picture, Bluish).centre_px;
  // From the path's start (-0.5, 0) to the box's middle (2.2, 1.1): to the right and up.
  EXPECT_NEAR((box_px - start_px).x() / px_per_m, 2.7, 0.02);  // m
  EXPECT_NEAR((box_px - start_px).y() / px_per_m, -1.1, 0.02);
}

TEST_F(Views, ShowHeightsFromTheSideUnexaggerated) {
  Write(MapCloud(kViewCell), PathAlongX());
  const cv::Mat3b picture = Picture("view_side.png");
  const double px_per_m = BarPx(picture) / 1.0;
  const auto start = [](const cv::Vec3b& pixel) { return Alike(pixel, kStartColour); };
  // Lines one pixel wide are mixed with what lies behind them.
  const auto magenta = [](const cv::Vec3b& pixel) {
    return pixel[2] > pixel[1] + 40 && pixel[0] > pixel[1] + 20;
  };
  const Eigen::Vector2d offset_px =
      Find(picture, Bluish).centre_px - Find(picture, start).centre_px;
  EXPECT_NEAR(offset_px.x() / px_per_m, 2.7, 0.02);  // m
  // The box's roof is as high as the ground below it and 0.4 m, the start is at zero.
  EXPECT_NEAR(-offset_px.y() / px_per_m, GroundHeight(2.2, 1.1) + 0.4, 0.02);
  // Plumb lines go from the path, at zero, to the ground 0.85 to 1.05 m below.
  const double start_row = Find(picture, start).centre_px.y();
  for (const double below_m : {0.5, 0.8}) {
    const cv::Mat3b row = picture.row(static_cast<int>(start_row + below_m * px_per_m));
    EXPECT_GT(std::count_if(row.begin(), row.end(), magenta), 1) << below_m;
  }
  const cv::Mat3b under_ground = picture.row(static_cast<int>(start_row + 1.2 * px_per_m));
  EXPECT_EQ(std::count_if(under_ground.begin(), under_ground.end(), magenta), 0);
}

TEST_F(Views, TurnWithThePathNotWithTheWorld) {
  // Driven along y: from the side, y goes to the right.
  Write(MapCloud(kViewCell), Path({{0.0, -0.4, 0.0}, {0.0, 1.4, 0.0}}));
  const cv::Mat3b picture = Picture("view_side.png");
  const auto start = [](const cv::Vec3b& pixel) { return Alike(pixel, kStartColour); };
  const auto end = [](const cv::Vec3b& pixel) { return Alike(pixel, kPathColour); };
  const double start_px = Find(picture, start).centre_px.x();
  EXPECT_GT(Find(picture, end).centre_px.x(), start_px);
  EXPECT_GT(Find(picture, Bluish).centre_px.x(), start_px);
}

TEST_F(Views, LeaveNoHolesInAClosedSurface) {
  Write(MapCloud(kViewCell), {});
  const cv::Mat3b picture = Picture("view_top.png");
  const auto empty = [](const cv::Vec3b& pixel) { return Alike(pixel, kBackgroundColour); };
  // Besides the margins, a step of the extent (5 cm) on each side.
  const double scale = BarPx(picture);
  const double rim_px = 2.0 * kMarginPx + 0.1 * scale;
  const double all = static_cast<double>(picture.total()) - kFooterPx * picture.cols;
  const double surface = (picture.cols - rim_px) * (picture.rows - kFooterPx - rim_px);
  EXPECT_LE(Find(picture, empty).count, all - surface);
}

// Their squares lie in the ground, in their cubes: held towards the viewer, around where the points
// happen to lie, they would look like stairs, with gaps.
TEST_F(Views, ShadeCoarseLevelGroundEvenly) {
  constexpr float kGrain = 0.08F;
  const auto contrast = [&](const Eigen::Vector3f& normal) {
    PointCloud cloud;
    SeededRandom random;
    for (int x = 0; x < 50; ++x) {
      for (int y = 0; y < 40; ++y) {
        SurfacePoint& point = cloud.emplace_back();
        point.x_in_world = {kGrain * static_cast<float>(x + random.Uniform(0.01, 0.99)),
                            kGrain * static_cast<float>(y + random.Uniform(0.01, 0.99)), 0.0F};
        point.normal = normal;
        point.rgb = {120, 120, 120};
        point.observations = 4;
        point.grain_m = kGrain;
      }
    }
    Write(cloud, {});
    const cv::Mat3b picture = Picture("view_oblique.png");
    const cv::Rect middle(picture.cols / 3, picture.rows / 3, picture.cols / 3, picture.rows / 6);
    cv::Scalar mean, spread;
    cv::meanStdDev(picture(middle), mean, spread);
    return spread[0];
  };
  const double stairs = contrast(Eigen::Vector3f::Zero());
  EXPECT_GT(stairs, 3.0);
  EXPECT_LT(contrast(Eigen::Vector3f::UnitZ()), 0.2 * stairs);
}

TEST_F(Views, HaveEqualBytesWhateverTheOrderOfThePoints) {
  PointCloud cloud = MapCloud(0.05);
  Write(cloud, PathAlongX());
  const std::string top = ReadTextFile(folder_.Path() / "view_top.png");
  const std::string oblique = ReadTextFile(folder_.Path() / "view_oblique.png");
  std::shuffle(cloud.begin(), cloud.end(), std::mt19937(7));
  Write(cloud, PathAlongX());
  EXPECT_TRUE(ReadTextFile(folder_.Path() / "view_top.png") == top);
  EXPECT_TRUE(ReadTextFile(folder_.Path() / "view_oblique.png") == oblique);
}

TEST_F(Views, ServeACloudOfOnePointWithoutPath) {
  Write({MapPoint(3.0, 4.0, 5.0, kBoxRgb)}, {});
  EXPECT_GT(Find(Picture("view_top.png"), Bluish).count, 10);
}

TEST_F(Views, RefuseOptionsOutOfRange) {
  options_ = {.picture_px = 10};
  EXPECT_THROW(Write({MapPoint(3.0, 4.0, 5.0)}, {}), UsageError);
}

TEST_F(Views, RefuseBadCloudsByName) {
  const auto complaint = [&] {
    return MessageOf<DataError>([&] {
      WriteSurfaceViews({folder_.Path() / "dense.ply", kViewCell}, PathAlongX(), folder_.Path(),
                        options_);
    });
  };
  EXPECT_THAT(complaint(), HasSubstr("dense.ply: cannot read"));
  WriteCloud(folder_.Path() / "dense.ply", {MapPoint(NAN, 0.0, 0.0)});
  EXPECT_THAT(complaint(), HasSubstr("dense.ply: expected points, found none"));
  EXPECT_THAT(NamesIn(folder_.Path()), UnorderedElementsAre("dense.ply"));
}

}  // namespace
}  // namespace rigmap
