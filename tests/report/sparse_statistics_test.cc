#include "report/sparse_statistics.h"

#include <gmock/gmock.h>

namespace rigmap {
namespace {

using testing::ElementsAre;
using testing::Pair;

// Three frames before a wall at 4 m; the middle one sees everything 0.5 px to the right.
SparseModel WallModel() {
  SparseModel model;
  const Camera camera{.width = 640, .height = 480, .fx = 400, .fy = 400, .cx = 320, .cy = 240};
  model.cameras.push_back({Eye::kLeft, camera});
  for (int frame = 0; frame < 3; ++frame) {
    SparseImage image;
    image.ref = {frame, Eye::kLeft};
    image.name = "left/" + std::to_string(1000 + frame) + ".png";
    model.images.push_back(image);
  }
  for (std::uint64_t id = 0; id < 400; ++id) {
    SparsePoint point{.id = id};
    point.x_in_model = {-2.0 + 0.2 * static_cast<double>(id % 20),
                        -1.5 + 0.15 * static_cast<double>(id / 20), 4.0};
    for (int frame = 0; frame < (id % 2 == 0 ? 3 : 2); ++frame) {
      SparseImage& image = model.images[static_cast<std::size_t>(frame)];
      Eigen::Vector2d pixel = Project(camera, point.x_in_model).value();
      if (frame == 1) pixel.x() += 0.5;
      point.track.push_back({image.ref, static_cast<std::uint32_t>(image.keypoints.size())});
      image.keypoints.push_back({pixel, id});
    }
    model.points.push_back(point);
  }
  return model;
}

TEST(SparseStatisticsTest, CountsTracksAndPoints) {
  const SparseStatistics statistics = StatisticsOf(WallModel());
  EXPECT_EQ(statistics.points, 400U);
  EXPECT_EQ(statistics.observations, 1000U);
  EXPECT_THAT(statistics.tracks, ElementsAre(Pair(2, 200U), Pair(3, 200U)));
  EXPECT_EQ(statistics.images.at(1000).points, 400U);
  EXPECT_EQ(statistics.images.at(1002).points, 200U);
}

TEST(SparseStatisticsTest, FindsResidualsAndWhereTheyAre) {
  const SparseStatistics statistics = StatisticsOf(WallModel());
  EXPECT_NEAR(statistics.images.at(1000).residual_px.value(), 0.0, 1e-9);
  EXPECT_NEAR(statistics.images.at(1001).residual_px.value(), 0.5, 1e-9);
  for (const ResidualCell& cell : statistics.field) {
    if (cell.count == 0) continue;
    EXPECT_GT(cell.mean_px.x(), 0.0);
    EXPECT_LT(cell.mean_px.x(), 0.5);
    EXPECT_NEAR(cell.mean_px.y(), 0.0, 1e-9);
  }
}

TEST(SparseStatisticsTest, CountsWhatFramesShare) {
  const SparseStatistics statistics = StatisticsOf(WallModel());
  ASSERT_EQ(statistics.matrix_side, 3);
  EXPECT_THAT(statistics.matrix, ElementsAre(400, 400, 200, 400, 400, 200, 200, 200, 200));
}

TEST(SparseStatisticsTest, OfNothingIsNothing) {
  const SparseStatistics statistics = StatisticsOf({});
  EXPECT_EQ(statistics.points, 0U);
  EXPECT_EQ(statistics.matrix_side, 0);
}

}  // namespace
}  // namespace rigmap
