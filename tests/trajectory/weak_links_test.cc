#include "trajectory/weak_links.h"

#include <gmock/gmock.h>

#include "tests/trajectory/odometric_part.h"

namespace rigmap {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr double kTight_m = 0.002, kWeak_m = 0.1, kRotation_rad = 1e-4;

// All frames adjusted where the odometry has them, each known to 2 mm against the one before; but
// for `weak`, which is known to 10 cm.
Part AdjustedPart(int frames, int weak) {
  Part part(frames);
  for (int i = 1; i < frames; ++i) {
    part.Adjust(i, part.odometry[i].world_from_left, Diagonal(kWeak_m, kRotation_rad));
  }
  part.TellLinks(Diagonal(kTight_m, kRotation_rad));
  if (weak < frames) part.adjustment.link_covariances[weak] = Diagonal(kWeak_m, kRotation_rad);
  return part;
}

TEST(WeakLinks, AreWhereTheOdometryKnowsFarMore) {
  const Part part = AdjustedPart(6, 3);
  EXPECT_THAT(WeakLinks(part.odometry, part.adjustment), ElementsAre(3));
}

TEST(WeakLinks, AreNoneWhereTheAdjustmentKnowsAsMuch) {
  EXPECT_THAT(WeakLinks(AdjustedPart(6, 6).odometry, AdjustedPart(6, 6).adjustment), IsEmpty());
  Part part = AdjustedPart(6, 3);
  part.odometry[3].step_covariance = Diagonal(0.05, kStepSigma_rad);
  EXPECT_THAT(WeakLinks(part.odometry, part.adjustment), IsEmpty());
}

// What calibration leaves unknown of the metres grows along the way and is no fault of a link.
TEST(WeakLinks, DoNotCountWhatTheCalibrationLeavesUnknown) {
  Part part = AdjustedPart(6, 6);
  part.adjustment.by_calibration.assign(6, PoseCalibration::Zero());
  part.adjustment.calibration_covariance = CalibrationMatrix::Identity();
  for (int i = 1; i < 6; ++i) {
    PoseCalibration& by_calibration = part.adjustment.by_calibration[i];
    by_calibration(2, 0) = i >= 3 ? 0.2 : 0.1;
    part.adjustment.covariances[i] += by_calibration * by_calibration.transpose();
  }
  EXPECT_THAT(WeakLinks(part.odometry, part.adjustment), IsEmpty());
}

TEST(WeakLinks, AreNotCutWhereBothContradictEachOther) {
  Part part = AdjustedPart(6, 3);
  for (int i = 3; i < 6; ++i) {
    part.adjustment.world_from_left[i]->translation += Eigen::Vector3d(1.0, 0.0, 0.0);
  }
  EXPECT_THAT(WeakLinks(part.odometry, part.adjustment), IsEmpty());
}

// Frame 4 hangs on frame 2, too, which the adjustment knows well; frame 5 hangs on frame 4.
TEST(WeakLinks, AreNotCutWhereAnotherFrameTiesBothSides) {
  Part part = AdjustedPart(6, 3);
  part.odometry[4].reference = 2;
  EXPECT_THAT(WeakLinks(part.odometry, part.adjustment), IsEmpty());
}

TEST(WeakLinks, AreNoneBetweenGroupsOrWithoutSigmas) {
  Part part = AdjustedPart(6, 3);
  part.adjustment.link_covariances[3].reset();
  EXPECT_THAT(WeakLinks(part.odometry, part.adjustment), IsEmpty());
  part = AdjustedPart(6, 3);
  part.adjustment.link_covariances.clear();
  EXPECT_THAT(WeakLinks(part.odometry, part.adjustment), IsEmpty());
}

}  // namespace
}  // namespace rigmap
