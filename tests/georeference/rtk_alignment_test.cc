#include "georeference/rtk_alignment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "georeference/fix_pairs.h"
#include "georeference/internal/antenna_path.h"
#include "georeference/local_frame.h"
#include "tests/georeference/rover_drive.h"

namespace rigmap {
namespace {

Rigid2 RandomPlacing(SeededRandom& random) {
  const double angle_rad = random.Uniform(-std::numbers::pi, std::numbers::pi);
  const double east_m = random.Uniform(-50.0, 50.0);
  return {angle_rad, {east_m, random.Uniform(-50.0, 50.0)}};
}

// Where the alignment has a place of the world, in metres around the drive's own origin.
Eigen::Vector2d PositionOf(const RtkAlignment& alignment, const Eigen::Vector2d& x_in_world) {
  const Eigen::Vector2d position = alignment.plane_from_world * x_in_world;
  const LocalFrame plane(alignment.plane_origin), katwijk({52.2141, 4.4004, 6.0});
  return katwijk.ToEnu(plane.ToGeodetic({position.x(), position.y(), 0.0})).head<2>();
}

double AngleBetween(double a_rad, double b_rad) {
  return std::abs(std::remainder(a_rad - b_rad, 2.0 * std::numbers::pi));
}

TEST(RtkAlignment, FindsMotionAndClockWithinItsSigmas) {
  SeededRandom random;
  const RoverDrive drive(SCurve(), 60.0);
  double normalised_square = 0.0;
  constexpr int kRuns = 40;
  int rejected = 0;
  for (int run = 0; run < kRuns; ++run) {
    const Rigid2 truth = RandomPlacing(random);
    const double offset_s = random.Uniform(-2.0, 2.0);
    const RtkFit fit =
        AlignToRtk(drive.Fixes(truth, offset_s, random), drive.Poses(0.0, random), kAntennaInLeft);
    ASSERT_TRUE(fit.alignment) << fit.why;
    const RtkAlignment& alignment = *fit.alignment;
    ASSERT_TRUE(alignment.clock_offset_sigma_s) << fit.why;
    EXPECT_EQ(fit.why, "");
    EXPECT_LT(*alignment.clock_offset_sigma_s, 0.05);  // s
    const double sigmas = (alignment.clock_offset_s - offset_s) / *alignment.clock_offset_sigma_s;
    EXPECT_LT(std::abs(sigmas), 4.5);
    normalised_square += sigmas * sigmas / kRuns;
    EXPECT_LT(AngleBetween(alignment.plane_from_world.angle_rad, truth.angle_rad),
              4.5 * std::sqrt(alignment.covariance(2, 2)) + 2e-5);  // the planes differ by 1e-5
    for (const double ahead_m : {0.0, 5.0, 15.0}) {
      const Eigen::Vector2d position(ahead_m, 3.0);
      EXPECT_LT((PositionOf(alignment, position) - truth * position).norm(),
                4.5 * std::sqrt(2.0) * alignment.SigmaAt(position));
    }
    EXPECT_GT(alignment.rms_residual_m, 0.002);
    EXPECT_LT(alignment.rms_residual_m, 0.010);  // the fixes' 6 mm, less what was fitted
    rejected += alignment.rejected;
  }
  EXPECT_LE(rejected, 3);  // of some 800, a few in ten thousand of which lie beyond four sigmas
  EXPECT_GT(normalised_square, 0.5);
  EXPECT_LT(normalised_square, 1.8);
}

TEST(RtkAlignment, PairsTheFixesThatAgreeWithItWithThePath) {
  SeededRandom random;
  const RoverDrive drive(SCurve(), 60.0);
  auto fixes = drive.Fixes(RandomPlacing(random), 0.8, random);
  const auto poses = drive.Poses(0.0, random);
  fixes[5].latitude_deg += 1e-5;  // a metre
  fixes[9].status = "RTK_FLOAT";
  const RtkFit fit = AlignToRtk(fixes, poses, kAntennaInLeft);
  ASSERT_TRUE(fit.alignment) << fit.why;
  std::ranges::reverse(fixes);
  const auto pairs = PairFixes(fixes, poses, kAntennaInLeft, *fit.alignment);
  EXPECT_EQ(static_cast<int>(pairs.size()), fit.alignment->used);
  double squares = 0.0;
  for (const FixPair& pair : pairs) {
    const Eigen::Vector2d laid = fit.alignment->plane_from_world * pair.antenna_in_world.head<2>();
    squares += (laid - pair.fix_in_enu.head<2>()).squaredNorm() / static_cast<double>(pairs.size());
  }
  EXPECT_NEAR(std::sqrt(squares), fit.alignment->rms_residual_m, 1e-9);
  const Eigen::Vector3d start = drive.WorldFromLeft(0.0) * kAntennaInLeft;
  EXPECT_NEAR(pairs.front().antenna_in_world.z(), start.z(), 0.1);  // the camera rolls a little
}

TEST(RtkAlignment, NeedsTheLeverArm) {
  SeededRandom random;
  const RoverDrive drive(SCurve(), 60.0);
  const auto fixes = drive.Fixes(RandomPlacing(random), 0.0, random);
  const auto poses = drive.Poses(0.0, random);
  RtkAlignmentOptions options;
  options.max_place_sigma_m = 1.0;
  const RtkFit with = AlignToRtk(fixes, poses, kAntennaInLeft, options);
  // Seen from above, an arm along the way is nearly a clock offset; one across it is not.
  const RtkFit without =
      AlignToRtk(fixes, poses, kAntennaInLeft + Eigen::Vector3d(0.5, 0.0, 0.0), options);
  ASSERT_TRUE(with.alignment && without.alignment);
  EXPECT_GT(without.alignment->rms_residual_m, 4.0 * with.alignment->rms_residual_m);
}

// Neither tells the clock from a motion of the plane, noise in the poses or not.
TEST(RtkAlignment, HoldsTheClockOnLinesAndCirclesAtConstantSpeed) {
  SeededRandom random;
  for (const Steering& steering : {Straight(), Circle()}) {
    const RoverDrive drive(steering, 60.0);
    for (const double sigma_m : {0.0, 0.002, 0.01}) {
      const Rigid2 truth = RandomPlacing(random);
      const RtkFit fit =
          AlignToRtk(drive.Fixes(truth, 0.4, random), drive.Poses(sigma_m, random), kAntennaInLeft);
      ASSERT_TRUE(fit.alignment) << fit.why;
      EXPECT_FALSE(fit.alignment->clock_offset_sigma_s);
      EXPECT_EQ(fit.alignment->clock_offset_s, 0.0);
      EXPECT_NE(fit.why.find("held at 0"), std::string::npos) << fit.why;
      EXPECT_NEAR(fit.alignment->unknown_clock_sigma_m, 0.5 * 0.3, 0.02);  // s times m/s
      EXPECT_GE(fit.alignment->SigmaAt({5.0, 0.0}), fit.alignment->unknown_clock_sigma_m);
      // The offset of 0.4 s has moved the map by its way, no more.
      const Eigen::Vector2d position(9.0, 0.0);
      EXPECT_LT((PositionOf(*fit.alignment, position) - truth * position).norm(),
                0.4 * 0.3 * 4.0 + 0.05);
    }
  }
}

TEST(RtkAlignment, StopsTellTheClockOnALine) {
  SeededRandom random;
  const RoverDrive drive(StraightAndStop(), 60.0);
  for (int run = 0; run < 5; ++run) {
    const RtkFit fit = AlignToRtk(drive.Fixes(RandomPlacing(random), -0.7, random),
                                  drive.Poses(0.002, random), kAntennaInLeft);
    ASSERT_TRUE(fit.alignment) << fit.why;
    ASSERT_TRUE(fit.alignment->clock_offset_sigma_s) << fit.why;
    EXPECT_NEAR(fit.alignment->clock_offset_s, -0.7, 5.0 * *fit.alignment->clock_offset_sigma_s);
  }
}

TEST(RtkAlignment, LeavesOutOutliersAndOtherStatuses) {
  SeededRandom random;
  const RoverDrive drive(SCurve(), 60.0);
  for (int run = 0; run < 10; ++run) {
    const Rigid2 truth = RandomPlacing(random);
    auto fixes = drive.Fixes(truth, 0.4, random);
    const auto poses = drive.Poses(0.0, random);
    const RtkFit clean = AlignToRtk(fixes, poses, kAntennaInLeft);
    for (const std::size_t wild : {4U, 9U, 15U}) fixes[wild].latitude_deg += 2e-5;  // 2.2 m
    for (const std::size_t afloat : {6U, 11U}) {
      fixes[afloat].longitude_deg += 1e-5;  // 0.7 m
      fixes[afloat].status = "RTK_FLOAT";
    }
    const RtkFit fit = AlignToRtk(fixes, poses, kAntennaInLeft);
    ASSERT_TRUE(clean.alignment && fit.alignment) << fit.why;
    EXPECT_EQ(fit.alignment->rejected, 5);
    EXPECT_EQ(fit.alignment->used, clean.alignment->used - 5);
    ASSERT_TRUE(fit.alignment->clock_offset_sigma_s);
    EXPECT_NEAR(fit.alignment->clock_offset_s, 0.4, 4.5 * *fit.alignment->clock_offset_sigma_s);
    EXPECT_LT((PositionOf(*fit.alignment, {5.0, 1.0}) - truth * Eigen::Vector2d(5.0, 1.0)).norm(),
              0.02);  // m
  }
}

// A place at the far end of the Earth does not carry the plane away.
TEST(RtkAlignment, IsNotCarriedAwayByAFixElsewhere) {
  SeededRandom random;
  const RoverDrive drive(SCurve(), 60.0);
  auto fixes = drive.Fixes({}, 0.0, random);
  fixes[2].latitude_deg = fixes[2].longitude_deg = 0.0;
  const RtkFit fit = AlignToRtk(fixes, drive.Poses(0.0, random), kAntennaInLeft);
  ASSERT_TRUE(fit.alignment) << fit.why;
  EXPECT_EQ(fit.alignment->rejected, 1);
  EXPECT_LT(PositionOf(*fit.alignment, Eigen::Vector2d::Zero()).norm(), 0.03);  // m
}

TEST(RtkAlignment, OrderAndAWholeDayChangeNothing) {
  SeededRandom random;
  const RoverDrive drive(SCurve(), 60.0);
  auto fixes = drive.Fixes(RandomPlacing(random), 0.4, random);
  auto poses = drive.Poses(0.002, random);
  const RtkFit before = AlignToRtk(fixes, poses, kAntennaInLeft);
  constexpr StampNs kDayNs = 86'400'000'000'000;
  std::ranges::reverse(fixes);
  for (GnssFix& fix : fixes) fix.stamp_ns += kDayNs;
  for (TimedPose& pose : poses) pose.stamp_ns += kDayNs;
  const RtkFit after = AlignToRtk(fixes, poses, kAntennaInLeft);
  ASSERT_TRUE(before.alignment && after.alignment);
  EXPECT_NEAR(before.alignment->clock_offset_s, after.alignment->clock_offset_s, 1e-6);
  EXPECT_NEAR(before.alignment->rms_residual_m, after.alignment->rms_residual_m, 1e-9);
}

TEST(RtkAlignment, SaysWhyThereIsNone) {
  SeededRandom random;
  const RoverDrive drive(SCurve(), 60.0);
  const auto fixes = drive.Fixes({}, 0.0, random);
  const auto poses = drive.Poses(0.0, random);
  const auto none = [](const RtkFit& fit, const std::string& reason) {
    EXPECT_FALSE(fit.alignment);
    EXPECT_NE(fit.why.find(reason), std::string::npos) << fit.why;
  };
  none(AlignToRtk({}, poses, kAntennaInLeft), "found none");
  none(AlignToRtk(fixes, {}, kAntennaInLeft), "found none");
  const std::vector<GnssFix> two(fixes.begin() + 5, fixes.begin() + 7);
  none(AlignToRtk(two, poses, kAntennaInLeft), "found 2");
  const RoverDrive still([](double) { return Eigen::Vector2d(0.0, 0.0); }, 60.0);
  none(AlignToRtk(still.Fixes({}, 0.0, random), still.Poses(0.001, random), kAntennaInLeft),
       "expected");
  // 0.3 m of way leave the heading to more than a degree.
  const RoverDrive creep([](double) { return Eigen::Vector2d(0.02, 0.0); }, 15.0);
  none(AlignToRtk(creep.Fixes({}, 0.0, random), creep.Poses(0.0, random), kAntennaInLeft),
       "too short a path");
}

// What strays has to be judged all the same.
TEST(RtkAlignment, APathOfAnotherScaleIsLaidOnItsFixesWeakly) {
  SeededRandom random;
  const RoverDrive drive(SCurve(), 60.0);
  const auto fixes = drive.Fixes({}, 0.0, random);
  Trajectory poses = drive.Poses(0.0, random);
  constexpr double kMaxSigma_m = 1.0;
  EXPECT_FALSE(AlignToRtkWeakly(fixes, poses, kAntennaInLeft, {}, kMaxSigma_m).is_weak);
  for (TimedPose& pose : poses) pose.world_from_left.translation *= 1.05;
  const RtkFit refused = AlignToRtk(fixes, poses, kAntennaInLeft);
  ASSERT_FALSE(refused.alignment);
  const RtkFit weak = AlignToRtkWeakly(fixes, poses, kAntennaInLeft, {}, kMaxSigma_m);
  ASSERT_TRUE(weak.alignment);
  EXPECT_TRUE(weak.is_weak);
  EXPECT_EQ(weak.why, refused.why);
  EXPECT_GT(weak.alignment->rms_residual_m, 0.02);
}

TEST(RtkAlignment, PredictedPosesDoNotCount) {
  SeededRandom random;
  const RoverDrive drive(SCurve(), 60.0);
  const auto fixes = drive.Fixes({}, 0.4, random);
  auto poses = drive.Poses(0.0, random);
  const RtkFit whole = AlignToRtk(fixes, poses, kAntennaInLeft);
  for (std::size_t i = 50; i < 75; ++i) {
    poses[i].source = PoseSource::kPredicted;
    poses[i].world_from_left.translation.y() += 3.0;
  }
  const RtkFit part = AlignToRtk(fixes, poses, kAntennaInLeft);
  ASSERT_TRUE(whole.alignment && part.alignment);
  EXPECT_EQ(part.alignment->rejected, 0);
  EXPECT_LT(part.alignment->used, whole.alignment->used);
}

TEST(RtkAlignment, AnExactClockIsNoWeakness) {
  SeededRandom random;
  const RoverDrive drive(SCurve(), 60.0);
  const auto fixes = drive.Fixes(RandomPlacing(random), 0.0, random);
  const RtkFit fit =
      AlignToRtk(fixes, drive.Poses(0.0, random), kAntennaInLeft, {.max_clock_offset_s = 0.0});
  ASSERT_TRUE(fit.alignment) << fit.why;
  EXPECT_EQ(fit.why, "");
  EXPECT_EQ(fit.alignment->clock_offset_s, 0.0);
  EXPECT_EQ(fit.alignment->unknown_clock_sigma_m, 0.0);
}

TEST(RtkAlignment, RefusesOptionsOutOfRange) {
  RtkAlignmentOptions options;
  options.max_clock_offset_s = -1.0;
  EXPECT_THROW(AlignToRtk({}, {}, kAntennaInLeft, options), UsageError);
  options = {};
  options.max_place_sigma_m = 0.0;
  EXPECT_THROW(RequireValid(options), UsageError);
}

TEST(AntennaPath, PassesThePosesAndEndsWithThem) {
  SeededRandom random;
  const RoverDrive drive(SCurve(), 10.0);
  auto poses = drive.Poses(0.0, random);
  poses.erase(poses.begin() + 5, poses.begin() + 15);
  const AntennaPath path(poses, kAntennaInLeft, 3.0);
  for (const TimedPose& pose : poses) {
    const auto position = path.At(path.SecondsOf(pose.stamp_ns));
    ASSERT_TRUE(position);
    EXPECT_LT((*position - (pose.world_from_left * kAntennaInLeft).head<2>()).norm(), 1e-9);  // m
  }
  EXPECT_FALSE(path.At(-0.01));
  EXPECT_FALSE(path.At(10.01));
  EXPECT_FALSE(path.At(4.0));  // no pose for four seconds
  EXPECT_LT((*path.At(7.5) - (drive.WorldFromLeft(7.5) * kAntennaInLeft).head<2>()).norm(), 1e-3);
}

TEST(PlaneFit, InverseUndoesAndOutliersHardlyMatter) {
  SeededRandom random;
  for (int run = 0; run < 20; ++run) {
    const Rigid2 truth = RandomPlacing(random);
    const Eigen::Vector2d position = random.Vector(10.0).head<2>();
    EXPECT_LT((truth.Inverse() * (truth * position) - position).norm(), 1e-12);
    std::vector<PlanePair> pairs;
    for (int i = 0; i < 20; ++i) {
      const Eigen::Vector2d from = random.Vector(10.0).head<2>();
      pairs.push_back({from, truth * from, {0.01, 0.01}, {0.0, 0.0}});
    }
    for (std::size_t i = 0; i < 4; ++i) pairs[i].to += random.Vector(5.0).head<2>();
    const Rigid2 motion = FitRobustly(pairs);
    EXPECT_LT(AngleBetween(motion.angle_rad, truth.angle_rad), 0.003);
    EXPECT_LT((motion * Eigen::Vector2d::Zero() - truth.translation).norm(), 0.01);  // m
  }
}

}  // namespace
}  // namespace rigmap
