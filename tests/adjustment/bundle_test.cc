#include "adjustment/internal/bundle.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "tests/adjustment/rover_bundle.h"

namespace rigmap {
namespace {

constexpr double kHuberSigmas = 2.0, kFunctionTolerance = 1e-10;

using testing::Each;
using testing::Lt;

class BundleTest : public testing::Test {
 protected:
  // The rover's exact poses and points, with as much noise in the pixels as asked for.
  Bundle TrueBundle(double pixel_sigma) {
    rover_ = MakeSyntheticRover(
        {.frames = 5, .points_per_m2 = 4.0, .pixel_sigma = pixel_sigma, .seed = 17});
    const Correspondences correspondences = RoverCorrespondences(rover_, 4);
    Bundle bundle{rover_.rig, InverseOf(AllOf(rover_.world_from_left)), {}};
    bundle.points = TriangulateTracks(BuildTracks(correspondences, false), correspondences,
                                      rover_.rig, bundle.left_from_world, 8.0, 100.0);
    for (AdjustedPoint& point : bundle.points) point.x = TruePoint(rover_, point);
    return bundle;
  }

  SyntheticRover rover_;
  SeededRandom random_;
};

TEST_F(BundleTest, GoesBackToTheTruthFromCentimetresOff) {
  Bundle bundle = TrueBundle(0.0);
  for (std::size_t i = 1; i < bundle.left_from_world.size(); ++i) {
    bundle.left_from_world[i] = random_.Motion(0.02, 0.2 * kDegree) * *bundle.left_from_world[i];
  }
  for (AdjustedPoint& point : bundle.points) point.x += random_.Vector(0.01);
  SolveBundle(kHuberSigmas * 0.2, kFunctionTolerance, bundle);
  EXPECT_THAT(ErrorsPx(bundle), Each(Lt(1e-3)));
  for (std::size_t i = 0; i < bundle.left_from_world.size(); ++i) {
    const Vector6d error = ErrorOf(bundle.left_from_world[i]->Inverse(), rover_.world_from_left[i]);
    EXPECT_LT(error.norm(), 1e-5) << i;
  }
}

// The first frame is what all others are relative to.
TEST_F(BundleTest, HoldsFirstFrameAndRig) {
  Bundle bundle = TrueBundle(0.3);
  const Bundle before = bundle;
  SolveBundle(kHuberSigmas * 0.3, kFunctionTolerance, bundle);
  EXPECT_EQ(bundle.left_from_world[0]->translation, before.left_from_world[0]->translation);
  EXPECT_EQ(bundle.left_from_world[0]->rotation.coeffs(),
            before.left_from_world[0]->rotation.coeffs());
  EXPECT_NE(bundle.left_from_world[4]->translation, before.left_from_world[4]->translation);
  EXPECT_EQ(bundle.rig.right_from_left.translation, before.rig.right_from_left.translation);
}

// Noise is fitted as far as it can be: squares that are small count whole.
TEST_F(BundleTest, NeverLeavesLargerErrorsThanItFound) {
  Bundle bundle = TrueBundle(0.3);
  const auto sum_of_squares = [](const std::vector<double>& errors_px) {
    return std::inner_product(errors_px.begin(), errors_px.end(), errors_px.begin(), 0.0);
  };
  const double before = sum_of_squares(ErrorsPx(bundle));
  SolveBundle(1e6, kFunctionTolerance, bundle);
  EXPECT_LT(sum_of_squares(ErrorsPx(bundle)), before);
}

TEST_F(BundleTest, LeavesFramesWithoutAPoseWithoutOne) {
  Bundle bundle = TrueBundle(0.2);
  bundle.left_from_world[2].reset();
  for (AdjustedPoint& point : bundle.points) {
    std::erase_if(point.observations, [](const PointObservation& o) { return o.frame == 2; });
  }
  std::erase_if(bundle.points, [](const AdjustedPoint& point) { return !SpansFrames(point); });
  SolveBundle(kHuberSigmas * 0.2, kFunctionTolerance, bundle);
  EXPECT_FALSE(bundle.left_from_world[2]);
  EXPECT_EQ(ObservationsPerFrame(bundle)[2], 0);
}

TEST_F(BundleTest, ErrorsStandPointByPoint) {
  Bundle bundle = TrueBundle(0.0);
  EXPECT_THAT(ErrorsPx(bundle), Each(Lt(1e-6)));
  const std::size_t first = bundle.points[0].observations.size();
  bundle.points[1].observations[0].pixel += Eigen::Vector2d(3.0, 4.0);
  bundle.points[2].x = bundle.left_from_world[0]->Inverse() * Eigen::Vector3d(0.0, 0.0, -5.0);
  const std::vector<double> errors_px = ErrorsPx(bundle);
  EXPECT_NEAR(errors_px[first], 5.0, 1e-6);
  EXPECT_LT(errors_px[first - 1], 1e-6);
  EXPECT_LT(errors_px[first + 1], 1e-6);
  const std::size_t second = first + bundle.points[1].observations.size();
  EXPECT_EQ(errors_px[second], std::numeric_limits<double>::infinity()) << "behind the camera";
}

TEST_F(BundleTest, DropsWhatIsBeyondTheLimitAndNothingElse) {
  Bundle bundle = TrueBundle(0.3);
  bundle.points[0].observations[0].pixel.x() = std::numeric_limits<double>::quiet_NaN();
  constexpr double kLimitPx = 0.5;
  const std::vector<double> before = ErrorsPx(bundle);
  const auto count = static_cast<std::size_t>(
      std::ranges::count_if(before, [](double error_px) { return error_px <= kLimitPx; }));
  ASSERT_GT(count, before.size() / 2);
  DropBeyond(kLimitPx, before, bundle);
  const std::vector<double> after = ErrorsPx(bundle);
  EXPECT_THAT(after, Each(testing::Le(kLimitPx)));
  EXPECT_LE(after.size(), count) << "points that one frame shows go with their observations";
  for (const AdjustedPoint& point : bundle.points) EXPECT_TRUE(SpansFrames(point));
  const std::size_t points = bundle.points.size();
  DropBeyond(kLimitPx, after, bundle);
  EXPECT_EQ(bundle.points.size(), points);
  EXPECT_EQ(ErrorsPx(bundle), after);
}

TEST_F(BundleTest, EveryObservationIsCountedOnce) {
  const Bundle bundle = TrueBundle(0.2);
  const std::vector<int> counts = ObservationsPerFrame(bundle);
  ASSERT_EQ(counts.size(), 5U);
  EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), 0),
            static_cast<int>(ErrorsPx(bundle).size()));
}

}  // namespace
}  // namespace rigmap
