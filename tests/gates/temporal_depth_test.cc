#include "gates/temporal_depth.h"

#include <gtest/gtest.h>

#include "core/statistics.h"
#include "tests/gates/rover_adjustment.h"

namespace rigmap {
namespace {

Adjustment RoverWithNoise(double pixel_sigma) {
  SyntheticRoverOptions options;
  options.pixel_sigma = pixel_sigma;
  return RoverAdjustment(MakeSyntheticRover(options));
}

TEST(CompareDepths, FindsNoDifferenceInExactImages) {
  const Adjustment adjustment = RoverWithNoise(0.0);
  const auto differences = CompareDepths(adjustment);
  EXPECT_GT(differences.size(), 1000U);
  for (const DepthDifference& difference : differences) {
    EXPECT_NEAR(difference.difference_px, 0.0, 1e-4);
    const Eigen::Vector3d x = adjustment.world_from_left[difference.frame]->Inverse() *
                              adjustment.points[difference.track].x;
    // f b / z, but for the distortion, which shortens distances in the image.
    const double pinhole_px = adjustment.rig.right.camera.fx * adjustment.rig.Baseline() / x.z();
    EXPECT_LT(difference.disparity_px, 1.02 * pinhole_px);
    EXPECT_GT(difference.disparity_px, 0.6 * pinhole_px);
  }
}

TEST(CompareDepths, KnowsTheVarianceOfItsDifferences) {
  constexpr double kNoisePx = 0.2;
  std::vector<double> normalised;
  for (const DepthDifference& difference : CompareDepths(RoverWithNoise(kNoisePx))) {
    normalised.push_back(difference.difference_px / std::sqrt(difference.variance));
  }
  EXPECT_NEAR(kSigmaOfMedianDeviation * MedianAbsolute(normalised), kNoisePx, 0.05 * kNoisePx);
}

// A stereo match counts in its own frame only.
TEST(CompareDepths, LeavesAFramesStereoMatchOutOfItsTemporalDepth) {
  Adjustment adjustment = RoverWithNoise(0.2);
  const auto before = CompareDepths(adjustment);
  ASSERT_FALSE(before.empty());
  const DepthDifference& moved = before[before.size() / 2];
  for (PointObservation& observation : adjustment.points[moved.track].observations) {
    if (observation.frame == moved.frame && observation.eye == Eye::kRight) {
      observation.pixel.x() -= 1.0;
    }
  }
  const auto after = CompareDepths(adjustment);
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < before.size(); ++i) {
    const double change_px = after[i].difference_px - before[i].difference_px;
    EXPECT_NEAR(change_px, &before[i] == &moved ? 1.0 : 0.0, 1e-2);
  }
}

TEST(CompareDepths, LeavesOutWhatMotionTellsLessWellThanTheBaseline) {
  Adjustment standing = RoverWithNoise(0.2);
  // A hundredth of the way: 2 mm a step beside a baseline of 12 cm.
  Stretch(0.01, standing);
  EXPECT_TRUE(CompareDepths(standing).empty());
  EXPECT_TRUE(CompareDepths({}).empty());
}

}  // namespace
}  // namespace rigmap
