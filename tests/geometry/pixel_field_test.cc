#include "geometry/pixel_field.h"

#include <gtest/gtest.h>

namespace rigmap {
namespace {

// The edges of the image are half a pixel outside of the outermost centres.
TEST(PixelField, TakesTheNodesAtTheEdgesAndIsBilinearBetween) {
  const PixelField field{{2, 1, 200.0, 80.0},
                         {{0.0, 1.0}, {0.2, 1.0}, {0.0, 1.0}, {0.0, 3.0}, {0.4, 3.0}, {0.0, 3.0}}};
  EXPECT_TRUE(field.At({-0.5, -0.5}).isApprox(Eigen::Vector2d(0.0, 1.0)));
  EXPECT_TRUE(field.At({99.5, 79.5}).isApprox(Eigen::Vector2d(0.4, 3.0)));
  EXPECT_TRUE(field.At({49.5, 39.5}).isApprox(Eigen::Vector2d(0.15, 2.0)));
  EXPECT_TRUE(field.At({149.5, 19.5}).isApprox(Eigen::Vector2d(0.125, 1.5)));
}

TEST(PixelField, GoesOnBeyondTheImageAsAtItsEdge) {
  const PixelField field{{1, 1, 10.0, 10.0}, {{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}, {1.0, 1.0}}};
  EXPECT_EQ(field.At({50.0, -7.0}), Eigen::Vector2d(1.0, 0.0));
  EXPECT_EQ(field.At({-50.0, 99.0}), Eigen::Vector2d(0.0, 1.0));
}

}  // namespace
}  // namespace rigmap
