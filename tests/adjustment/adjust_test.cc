#include "adjustment/adjust.h"

#include <gmock/gmock.h>

#include <Eigen/Cholesky>

#include "tests/adjustment/rover_bundle.h"

namespace rigmap {
namespace {

double PathLength_m(const MaybePoses& poses) {
  double length_m = 0.0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    length_m += (poses[i].value().translation - poses[i - 1].value().translation).norm();
  }
  return length_m;
}

// Error of a pose in its own sigmas: chi-square of 6 degrees of freedom, divided by 6.
double NormalisedError(const Adjustment& adjustment, const SyntheticRover& rover,
                       std::size_t frame) {
  const Vector6d error =
      ErrorOf(adjustment.world_from_left[frame].value(), rover.world_from_left[frame]);
  return error.dot(adjustment.covariances[frame].ldlt().solve(error)) / 6.0;
}

// Moves a share of all pixels by this distance, in any direction; how many it moved.
int MovePixels(double share, double distance_px, Correspondences& correspondences,
               SeededRandom& random) {
  int moved = 0;
  const auto move = [&](auto& pixel) {
    if (random.Uniform(0.0, 1.0) >= share) return;
    const double angle = random.Uniform(0.0, 2.0 * std::numbers::pi);
    pixel += distance_px * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    ++moved;
  };
  for (auto& frame : correspondences.features) {
    for (Feature& feature : frame) {
      move(feature.left);
      if (feature.right) move(*feature.right);
    }
  }
  return moved;
}

TEST_F(AdjustTest, DataWithoutNoiseIsAFixedPoint) {
  Make({.frames = 6, .points_per_m2 = 8.0, .pixel_sigma = 0.0, .seed = 61});
  const Adjustment adjusted = Adjust(AllOf(rover_.world_from_left));
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_LT(ErrorOf(adjusted.world_from_left[i].value(), rover_.world_from_left[i]).norm(),
              1e-7);  // m, rad
  }
  EXPECT_LT(adjusted.reprojection_px, 1e-6);
  EXPECT_EQ(adjusted.outlier_share, 0.0);
  for (const AdjustedPoint& point : adjusted.points) {
    EXPECT_LT((point.x - TruePoint(rover_, point)).norm(), 1e-5);  // m
  }
}

TEST_F(AdjustTest, BadOdometryComesBackToWithinItsOwnSigmas) {
  Make({.frames = 12, .points_per_m2 = 15.0, .seed = 62});
  const auto odometric = BadOdometry();
  EXPECT_GT((odometric.back().translation - rover_.world_from_left.back().translation).norm(),
            0.02);  // m
  const Adjustment adjusted = Adjust(AllOf(odometric));
  for (std::size_t i = 1; i < 12; ++i) {
    EXPECT_LT(NormalisedError(adjusted, rover_, i), 4.0) << "frame " << i;
    const Vector6d error = ErrorOf(adjusted.world_from_left[i].value(), rover_.world_from_left[i]);
    EXPECT_LT(error.head<3>().norm(), 0.002);  // m
    EXPECT_LT(error.tail<3>().norm(), 0.02 * kDegree);
  }
  EXPECT_NEAR(adjusted.noise_px, 0.2, 0.01);
  EXPECT_LT(adjusted.outlier_share, 0.001);
}

TEST_F(AdjustTest, WhereItStartsDoesNotMatter) {
  Make({.frames = 10, .points_per_m2 = 10.0, .seed = 63});
  const Adjustment from_truth = Adjust(AllOf(rover_.world_from_left));
  const Adjustment from_odometry = Adjust(AllOf(BadOdometry()));
  EXPECT_LT(
      ErrorOf(*from_odometry.world_from_left.back(), *from_truth.world_from_left.back()).norm(),
      5e-5);  // m, rad; a tenth of a sigma
  EXPECT_EQ(from_odometry.points.size(), from_truth.points.size());
}

TEST_F(AdjustTest, TheFirstPosedFrameIsHeld) {
  Make({.frames = 8, .points_per_m2 = 8.0, .seed = 64});
  MaybePoses poses = AllOf(BadOdometry());
  poses[0].reset();
  poses[1] = *poses[1] * random_.Motion(0.02, 0.003);
  const Adjustment adjusted = Adjust(poses);
  EXPECT_FALSE(adjusted.world_from_left[0]);
  EXPECT_LT(ErrorOf(adjusted.world_from_left[1].value(), *poses[1]).norm(), 1e-12);  // m, rad
  EXPECT_EQ(adjusted.covariances[1], Matrix6d::Zero());
  EXPECT_GT(ErrorOf(adjusted.world_from_left[2].value(), *poses[2]).norm(), 1e-4);
}

TEST_F(AdjustTest, FewPointsDoNotPullAtAGroupThatIsHeld) {
  Make({.frames = 8, .points_per_m2 = 8.0, .seed = 66});
  // Frames from the fifth on start 3 mm aside, and share five tracks with those before.
  std::vector<Rigid3> start = rover_.world_from_left;
  for (std::size_t i = 4; i < 8; ++i) start[i].translation.x() += 0.003;
  const Correspondences all = correspondences_;
  CutBefore(4, correspondences_);
  const Adjustment apart = Adjust(AllOf(start));
  FramePair few = *std::ranges::find_if(
      all.pairs, [](const FramePair& pair) { return pair.a == 3 && pair.b == 4; });
  few.matches.resize(5);
  correspondences_.pairs.push_back(few);
  const Adjustment tied = Adjust(AllOf(start));
  ASSERT_EQ(tied.datum_frames[5], 4);
  for (const std::size_t i : {1, 2, 3, 5, 6, 7}) {
    EXPECT_LT(ErrorOf(*tied.world_from_left[i], *apart.world_from_left[i]).norm(), 1e-6) << i;
  }
}

TEST_F(AdjustTest, TheResultMovesWithTheGauge) {
  Make({.frames = 6, .points_per_m2 = 8.0, .seed = 65});
  auto poses = BadOdometry();
  const Adjustment here = Adjust(AllOf(poses));
  const Rigid3 moved_from_world = random_.Motion(20.0);
  for (Rigid3& pose : poses) pose = moved_from_world * pose;
  const Adjustment there = Adjust(AllOf(poses));
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_LT(
        ErrorOf(*there.world_from_left[i], moved_from_world * *here.world_from_left[i]).norm(),
        1e-5);  // m, rad
  }
}

TEST_F(AdjustTest, WrongPixelsAreDroppedAndCounted) {
  Make({.frames = 10, .points_per_m2 = 10.0, .seed = 66});
  const Correspondences clean = correspondences_;
  MovePixels(0.05, 20.0, correspondences_, random_);
  const Adjustment adjusted = Adjust(AllOf(BadOdometry()));
  int kept = 0, wrong = 0;
  for (const AdjustedPoint& point : adjusted.points) {
    for (const PointObservation& o : point.observations) {
      const Feature& feature = clean.features[o.frame][o.feature];
      const Eigen::Vector2d right_one =
          o.eye == Eye::kLeft ? feature.left : Eigen::Vector2d(*feature.right);
      wrong += o.pixel == right_one ? 0 : 1;
      ++kept;
    }
  }
  EXPECT_LT(wrong, 1e-3 * kept);
  EXPECT_NEAR(adjusted.outlier_share, 0.05, 0.01);
  EXPECT_NEAR(adjusted.noise_px, 0.2, 0.01);
  EXPECT_LT(NormalisedError(adjusted, rover_, 9), 4.0);
}

TEST_F(AdjustTest, FramesWithoutAPoseStayWithout) {
  Make({.frames = 8, .points_per_m2 = 8.0, .seed = 67});
  MaybePoses poses = AllOf(BadOdometry());
  poses[3].reset();
  poses[7].reset();
  const Adjustment adjusted = Adjust(poses);
  for (int i = 0; i < 8; ++i) {
    EXPECT_EQ(adjusted.world_from_left[i].has_value(), i != 3 && i != 7) << i;
  }
  EXPECT_LT(NormalisedError(adjusted, rover_, 6), 4.0);
}

TEST_F(AdjustTest, AFrameWithHardlyAnObservationLosesItsPose) {
  Make({.frames = 6, .points_per_m2 = 8.0, .seed = 68});
  for (FramePair& pair : correspondences_.pairs) {
    if (pair.a == 2 || pair.b == 2) pair.matches.resize(1);
  }
  const Adjustment adjusted = Adjust(AllOf(rover_.world_from_left));
  EXPECT_FALSE(adjusted.world_from_left[2]);
  EXPECT_TRUE(adjusted.world_from_left[1]);
  EXPECT_TRUE(adjusted.world_from_left[5]);
}

TEST_F(AdjustTest, AFrameOnAWildPoseDoesNotSpoilTheOthers) {
  Make({.frames = 8, .points_per_m2 = 10.0, .seed = 69});
  MaybePoses poses = AllOf(rover_.world_from_left);
  poses[4]->translation += Eigen::Vector3d(0.3, -0.5, 0.2);
  const Adjustment adjusted = Adjust(poses);
  for (std::size_t i : {1, 2, 3, 5, 6, 7}) {
    EXPECT_LT(NormalisedError(adjusted, rover_, i), 4.0) << "frame " << i;
  }
}

TEST_F(AdjustTest, NothingToAdjustIsNoError) {
  Make({.frames = 3, .points_per_m2 = 2.0, .seed = 70});
  correspondences_.pairs.clear();
  const Adjustment adjusted = Adjust(AllOf(rover_.world_from_left));
  EXPECT_TRUE(adjusted.points.empty());
  EXPECT_THAT(adjusted.world_from_left, testing::Each(testing::Eq(std::nullopt)));
  EXPECT_EQ(adjusted.covariances.size(), 3u);
  EXPECT_FALSE(adjusted.calibration);
  EXPECT_EQ(Adjust(MaybePoses(3)).world_from_left.size(), 3u);
}

TEST_F(AdjustTest, MetresComeFromTheRig) {
  Make({.frames = 8, .points_per_m2 = 10.0, .seed = 71});
  const double length_m = PathLength_m(Adjust(AllOf(rover_.world_from_left)).world_from_left);
  rover_.rig.right_from_left.translation *= 0.5;
  std::vector<Rigid3> poses = rover_.world_from_left;
  for (Rigid3& pose : poses) pose.translation *= 0.48;  // the odometry would have found about half
  const double half_m = PathLength_m(Adjust(AllOf(poses)).world_from_left);
  EXPECT_NEAR(half_m / length_m, 0.5, 0.0005);
}

TEST_F(AdjustTest, PartsThatShareNothingKeepTheirStartingPositions) {
  Make({.frames = 10, .points_per_m2 = 8.0, .seed = 72});
  CutBefore(4, correspondences_);
  const auto odometric = BadOdometry();
  const Adjustment adjusted = Adjust(AllOf(odometric));
  EXPECT_THAT(adjusted.datum_frames, testing::ElementsAre(0, 0, 0, 0, 4, 4, 4, 4, 4, 4));
  EXPECT_LT(ErrorOf(*adjusted.world_from_left[4], odometric[4]).norm(), 1e-12);  // m, rad
  // Within the second part the path is as good as ever.
  const Rigid3 found = adjusted.world_from_left[4]->Inverse() * *adjusted.world_from_left[9];
  const Rigid3 truth = rover_.world_from_left[4].Inverse() * rover_.world_from_left[9];
  EXPECT_LT(ErrorOf(found, truth).norm(), 0.002);  // m, rad
}

TEST_F(AdjustTest, FramesThatAreToStandApartKeepTheirStartingMotion) {
  Make({.frames = 8});
  const std::vector<Rigid3> start = BadOdometry();
  const Adjustment apart = AdjustBundle({.correspondences = correspondences_,
                                         .rig = rover_.rig,
                                         .world_from_left = AllOf(start),
                                         .apart = {4}},
                                        {});
  for (int i = 0; i < 8; ++i) EXPECT_EQ(apart.datum_frames[i], i < 4 ? 0 : 4);
  EXPECT_LT(ErrorOf(*apart.world_from_left[4], start[4]).norm(), 1e-12);
  EXPECT_NEAR(apart.outlier_share, Adjust(AllOf(start)).outlier_share, 0.01)
      << "what was cut is no outlier";
}

TEST_F(AdjustTest, SigmasAreHonest) {
  // 6 x 30 degrees of freedom: by chance within 0.75 and 1.3.
  constexpr int kTrials = 30;
  double sum = 0.0;
  for (unsigned trial = 0; trial < kTrials; ++trial) {
    Make({.frames = 8, .points_per_m2 = 6.0, .seed = 100 + trial});
    const auto odometric = DriftingPoses(rover_, 0.002, 0.0005, random_);
    // The rig is exact, and said to be.
    const AdjustmentOptions options{.refine_rig = RigRefinement::kNone,
                                    .rig_prior_deg = 1e-6,
                                    .focal_prior_pct = 1e-6,
                                    .principal_point_prior_px = 1e-6,
                                    .distortion_prior_px = 1e-6,
                                    .shared_noise = 1.0};
    sum += NormalisedError(Adjust(AllOf(odometric), options), rover_, 7);
  }
  EXPECT_GT(sum / kTrials, 0.5);
  EXPECT_LT(sum / kTrials, 2.0);
}

// A displacement of the right eye's pixels that no lens model of ours has: waves along the rows.
class LensTest : public AdjustTest {
 protected:
  void Bend(double amplitude_px) {
    const Camera& camera = rover_.rig.right.camera;
    for (auto& frame : correspondences_.features) {
      for (Feature& feature : frame) {
        if (!feature.right) continue;
        const double waves = feature.right->x() / camera.width * 2.5;
        feature.right->x() += amplitude_px * std::sin(2.0 * std::numbers::pi * waves);
      }
    }
  }

  double WorstError_m(const Adjustment& adjusted) const {
    double worst_m = 0.0;
    for (std::size_t i = 0; i < rover_.world_from_left.size(); ++i) {
      const Vector6d error = ErrorOf(*adjusted.world_from_left[i], rover_.world_from_left[i]);
      worst_m = std::max(worst_m, error.head<3>().norm());
    }
    return worst_m;
  }
};

TEST_F(LensTest, WhatItsModelLacksIsTakenOut) {
  Make({.frames = 24, .points_per_m2 = 12.0, .pixel_sigma = 0.1, .seed = 75});
  Bend(0.3);
  const MaybePoses start = AllOf(rover_.world_from_left);
  const Adjustment bent = Adjust(start, {.lens_field_px = 0.0}), mended = Adjust(start);
  EXPECT_EQ(bent.lens_field_rms_px, 0.0);
  EXPECT_GT(mended.lens_field_rms_px, 0.03);
  EXPECT_GT(bent.noise_px, 0.115);
  EXPECT_NEAR(mended.noise_px, 0.1, 0.005) << "what was put in";
  EXPECT_LT(WorstError_m(mended), 0.7 * WorstError_m(bent));
}

TEST_F(LensTest, OneThatIsAsModelledIsLeftAlone) {
  Make({.frames = 24, .points_per_m2 = 12.0, .pixel_sigma = 0.1, .seed = 75});
  const MaybePoses start = AllOf(rover_.world_from_left);
  const Adjustment without = Adjust(start, {.lens_field_px = 0.0}), with = Adjust(start);
  EXPECT_EQ(with.lens_field_rms_px, 0.0);
  EXPECT_EQ(with.world_from_left[23]->translation, without.world_from_left[23]->translation);
}

TEST_F(AdjustTest, EqualInputGivesEqualOutput) {
  Make({.frames = 6, .points_per_m2 = 8.0, .seed = 73});
  const auto odometric = BadOdometry();
  const Adjustment once = Adjust(AllOf(odometric)), again = Adjust(AllOf(odometric));
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(once.world_from_left[i]->translation, again.world_from_left[i]->translation);
    EXPECT_EQ(once.world_from_left[i]->rotation.coeffs(),
              again.world_from_left[i]->rotation.coeffs());
    EXPECT_EQ(once.covariances[i], again.covariances[i]);
  }
  ASSERT_EQ(once.points.size(), again.points.size());
  for (std::size_t i = 0; i < once.points.size(); ++i) {
    ASSERT_EQ(once.points[i].x, again.points[i].x);
  }
}

}  // namespace
}  // namespace rigmap
