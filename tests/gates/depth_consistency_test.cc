#include "gates/depth_consistency.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/gates/rover_adjustment.h"

namespace rigmap {
namespace {

class DepthConsistencyTest : public testing::Test {
 protected:
  DepthConsistency Result() const {
    const auto result = DepthConsistencyOf(adjustment_);
    EXPECT_TRUE(result);
    return result.value_or(DepthConsistency{});
  }

  Adjustment adjustment_ = RoverAdjustment(MakeSyntheticRover());
};

TEST_F(DepthConsistencyTest, NoiseAloneIsNotSystematic) {
  const DepthConsistency result = Result();
  double squares = 0.0;
  int known = 0;
  for (const DepthPartition* partition : {&result.radius, &result.cells}) {
    for (const auto& region : partition->regions) {
      if (!region) continue;
      ++known;
      const auto [mean_pct, sigma_pct] = region->depth_pct;
      squares += mean_pct * mean_pct / (sigma_pct * sigma_pct);
      EXPECT_LT(std::abs(region->disparity_px.mean), 4.0 * region->disparity_px.sigma);
    }
    EXPECT_LT(partition->depth_pct.value, 2.0 * partition->depth_pct.sigma);
    EXPECT_LT(partition->disparity_px.value, 0.02);
  }
  EXPECT_GE(known, 12);
  // The standard errors are what the means scatter by.
  EXPECT_NEAR(std::sqrt(squares / known), 1.0, 0.35);
}

TEST_F(DepthConsistencyTest, AllTracksOfAPartitionAreInOneRegion) {
  const DepthConsistency result = Result();
  EXPECT_EQ(result.radius.regions.size(), 5U);
  EXPECT_EQ(result.cells.regions.size(), 12U);
  // The rover looks down: the uppermost row shows what is far.
  EXPECT_TRUE(result.cells.regions[5] && result.cells.regions[10]);
  const Camera& camera = adjustment_.rig.left.camera;
  EXPECT_NEAR(result.ring_width_px * 5, std::hypot(camera.width - 1.0 - camera.cx, camera.cy),
              40.0);
}

// What an adjustment would take up by its scale: here it shows, the same everywhere.
TEST_F(DepthConsistencyTest, ShowsAFactorInEveryRegion) {
  Stretch(1.01, adjustment_);
  const DepthConsistency result = Result();
  for (const auto& region : result.radius.regions) {
    if (!region) continue;
    EXPECT_NEAR(region->depth_pct.mean, -1.0, 4.0 * region->depth_pct.sigma + 0.02);
    EXPECT_GT(region->disparity_px.mean, 0.0);
  }
  EXPECT_NEAR(result.radius.depth_pct.value, 1.0, 0.1);
  EXPECT_NEAR(result.cells.depth_pct.value, 1.0, 0.1);
}

TEST_F(DepthConsistencyTest, ShowsALensThatIsWrongByItsRadius) {
  adjustment_.rig.right.camera.k1 += 0.01;
  const DepthConsistency result = Result();
  EXPECT_GT(result.radius.disparity_px.value, 10.0 * result.radius.disparity_px.sigma);
  EXPECT_GT(result.radius.depth_pct.value, 10.0 * result.radius.depth_pct.sigma);
  const auto &inner = result.radius.regions[0], &outer = result.radius.regions[3];
  ASSERT_TRUE(inner && outer);
  EXPECT_LT(std::abs(inner->disparity_px.mean), 0.1);
  EXPECT_GT(std::abs(outer->disparity_px.mean), 0.3);
}

// A turn of the right camera about its y shifts all disparities: far depths err more than near
// ones.
TEST_F(DepthConsistencyTest, ShowsAnOffsetOfDisparityByWhatIsFar) {
  adjustment_.rig.right_from_left.rotation =
      ExpRotation({0.0, 1.0 / 837.0, 0.0}) * adjustment_.rig.right_from_left.rotation;
  const DepthConsistency result = Result();
  const auto &far = result.cells.regions[5], &near = result.cells.regions[9];
  ASSERT_TRUE(far && near);
  EXPECT_NEAR(std::abs(far->disparity_px.mean), 1.0, 0.3);
  EXPECT_NEAR(std::abs(near->disparity_px.mean), 1.0, 0.3);
  EXPECT_GT(std::abs(far->depth_pct.mean), 1.5 * std::abs(near->depth_pct.mean));
}

TEST_F(DepthConsistencyTest, HasNothingToSayOfARigThatStands) {
  Stretch(0.01, adjustment_);
  EXPECT_FALSE(DepthConsistencyOf(adjustment_));
  EXPECT_FALSE(DepthConsistencyOf({}));
}

}  // namespace
}  // namespace rigmap
