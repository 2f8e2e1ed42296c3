#include "odometry/track_frames.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/seeded_random.h"
#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

// Noise as the options expect it of a stereo match; of matches they expect more.
constexpr double kPixelSigma = 0.1;

SyntheticRover Rover(const std::vector<Rigid3>& path) {
  return MakeSyntheticRover({.pixel_sigma = kPixelSigma}, path);
}

Odometry Track(const SyntheticRover& rover, const OdometryOptions& options = {}) {
  const auto features = [&](int frame) { return rover.frames[frame]; };
  return TrackFrames(static_cast<int>(rover.frames.size()), features, rover.rig, options);
}

// What is left of a frame when the lens is covered.
void Blacken(FrameFeatures& frame) {
  const StampNs stamp_ns = frame.stamp_ns;
  frame = FrameFeatures{.stamp_ns = stamp_ns};
}

// A frame that shows something else.
void Replace(FrameFeatures& frame, SeededRandom& random) {
  for (Descriptor& descriptor : frame.descriptors) {
    for (auto& value : descriptor) value = static_cast<std::uint8_t>(random.Uniform(0.0, 255.9));
  }
}

Rigid3 FromFirst(const SyntheticRover& rover, int frame) {
  return rover.world_from_left[0].Inverse() * rover.world_from_left[frame];
}

double PositionError_m(const SyntheticRover& rover, const Odometry& odometry, int frame) {
  return (odometry[frame].world_from_left.translation - FromFirst(rover, frame).translation).norm();
}

double WorstPosition_m(const SyntheticRover& rover, const Odometry& odometry) {
  double worst_m = 0.0;
  for (int i = 0; i < static_cast<int>(odometry.size()); ++i) {
    worst_m = std::max(worst_m, PositionError_m(rover, odometry, i));
  }
  return worst_m;
}

double WorstTurn_rad(const SyntheticRover& rover, const Odometry& odometry) {
  double worst_rad = 0.0;
  for (int i = 0; i < static_cast<int>(odometry.size()); ++i) {
    worst_rad = std::max(worst_rad, AngleOf(odometry[i].world_from_left.rotation.conjugate() *
                                            FromFirst(rover, i).rotation));
  }
  return worst_rad;
}

int Keyframes(const Odometry& odometry) {
  return static_cast<int>(std::count_if(odometry.begin(), odometry.end(),
                                        [](const auto& frame) { return frame.keyframe; }));
}

void ExpectAllPosed(const Odometry& odometry) {
  for (const auto& frame : odometry) EXPECT_EQ(frame.source, PoseSource::kOdometry);
}

// One keyframe's pose against another is good to 2 mm and 0.5 mrad with this noise; over the few
// keyframes of these drives that adds up to a centimetre and 2 mrad at most. Twice that is allowed.
constexpr double kMaxPosition_m = 0.02, kMaxTurn_rad = 0.004;

TEST(TrackFrames, FollowsARover) {
  const SyntheticRover rover = MakeSyntheticRover({.frames = 20, .pixel_sigma = kPixelSigma});
  const Odometry odometry = Track(rover);
  ASSERT_EQ(odometry.size(), 20u);
  ExpectAllPosed(odometry);
  EXPECT_LT(WorstPosition_m(rover, odometry), kMaxPosition_m);
  EXPECT_LT(WorstTurn_rad(rover, odometry), kMaxTurn_rad);
  EXPECT_TRUE(odometry[0].keyframe);
  EXPECT_EQ(odometry[0].reference, 0);
  EXPECT_EQ(odometry[0].step_covariance, Matrix6d::Zero());
  EXPECT_GT(Keyframes(odometry), 1);
  EXPECT_LT(Keyframes(odometry), 20);
  for (int i = 1; i < 20; ++i) {
    EXPECT_EQ(odometry[i].stamp_ns, rover.frames[i].stamp_ns);
    EXPECT_LT(odometry[i].reference, i);
    EXPECT_TRUE(odometry[odometry[i].reference].keyframe);
    EXPECT_GT(odometry[i].inliers, 100);
    EXPECT_FALSE(odometry[i].stands_still);
  }
}

// Of the first step of a rover, how far it is off: 6 on average if the covariance is honest.
double SquaredNormalisedError(const SyntheticRover& rover, const Odometry& odometry) {
  const Rigid3 found = odometry[1].world_from_left.Inverse() * odometry[0].world_from_left;
  const Rigid3 error = found * FromFirst(rover, 1);
  Vector6d perturbation;
  perturbation << error.translation, LogRotation(error.rotation);
  return perturbation.dot(odometry[1].step_covariance.ldlt().solve(perturbation));
}

TEST(TrackFrames, StepCovarianceIsAboutTheError) {
  // A match scatters by the noise of two keypoints, a disparity by that of two eyes.
  OdometryOptions options;
  options.keypoint_noise_px = kPixelSigma * std::sqrt(2.0);
  options.disparity_noise_px = kPixelSigma * std::sqrt(2.0);
  options.shared_noise = 1.0;
  double sum = 0.0;
  constexpr int kTrials = 60;
  for (unsigned seed = 1; seed <= kTrials; ++seed) {
    const SyntheticRover rover = MakeSyntheticRover(
        {.frames = 2, .points_per_m2 = 10.0, .pixel_sigma = kPixelSigma, .seed = seed});
    sum += SquaredNormalisedError(rover, Track(rover, options));
  }
  EXPECT_NEAR(sum / kTrials, 6.0, 0.2 * 6.0);
}

TEST(TrackFrames, EqualFramesGiveEqualPoses) {
  const SyntheticRover rover = MakeSyntheticRover({.frames = 6, .pixel_sigma = kPixelSigma});
  const Odometry first = Track(rover), second = Track(rover);
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(first[i].world_from_left.translation, second[i].world_from_left.translation);
    EXPECT_EQ(first[i].world_from_left.rotation.coeffs(),
              second[i].world_from_left.rotation.coeffs());
  }
}

TEST(TrackFrames, StandingStillInventsNoMotion) {
  const Odometry odometry = Track(Rover(std::vector<Rigid3>(10, RoverPose(1.0, 2.0, 0.3))));
  EXPECT_EQ(Keyframes(odometry), 1);
  for (std::size_t i = 1; i < odometry.size(); ++i) {
    EXPECT_EQ(odometry[i].world_from_left.translation, Eigen::Vector3d::Zero());
    EXPECT_EQ(odometry[i].world_from_left.rotation.coeffs(),
              Eigen::Quaterniond::Identity().coeffs());
    EXPECT_TRUE(odometry[i].stands_still);
    EXPECT_EQ(odometry[i].source, PoseSource::kOdometry);
  }
}

TEST(TrackFrames, OnlyNearPointsTellThatTheRigStands) {
  constexpr double kNear_px = 30.0;  // of disparity
  SyntheticRover rover = Rover(std::vector<Rigid3>(2, RoverPose(1.0, 2.0, 0.3)));
  EXPECT_TRUE(Track(rover)[1].stands_still);
  for (FrameFeatures& frame : rover.frames) {
    for (Feature& feature : frame.features) {
      if (feature.right && feature.left.x() - feature.right->x() > kNear_px) feature.right.reset();
    }
  }
  const Odometry far = Track(rover, {.disparity_noise_px = 0.15 * kNear_px});
  ASSERT_EQ(far[1].source, PoseSource::kOdometry);
  EXPECT_FALSE(far[1].stands_still);
}

TEST(TrackFrames, AMotionTakenForNoneIsInItsSigma) {
  double creep_m = 0.0, squared_sigmas = 0.0;
  for (double step_m = 0.0005; step_m < 0.02; step_m *= 1.2) {
    const Odometry odometry =
        Track(Rover({RoverPose(1.0, 2.0, 0.0), RoverPose(1.0 + step_m, 2.0, 0.0)}));
    if (!odometry[1].stands_still) break;
    creep_m = step_m;
    const Eigen::Vector3d ahead = -step_m * Eigen::Vector3d::UnitZ();  // level enough for this
    squared_sigmas = ahead.dot(
        Eigen::Matrix3d(odometry[1].step_covariance.topLeftCorner<3, 3>()).ldlt().solve(ahead));
  }
  EXPECT_GT(creep_m, 0.0005);
  EXPECT_LT(squared_sigmas, 6.0);
}

TEST(TrackFrames, FollowsARotationOnTheSpot) {
  std::vector<Rigid3> path;
  for (int i = 0; i < 20; ++i) path.push_back(RoverPose(0.0, 0.0, 0.12 * i));
  const SyntheticRover rover = Rover(path);
  const Odometry odometry = Track(rover);
  ExpectAllPosed(odometry);
  EXPECT_LT(WorstPosition_m(rover, odometry), 2.0 * kMaxPosition_m);  // more keyframes
  EXPECT_LT(WorstTurn_rad(rover, odometry), 2.0 * kMaxTurn_rad);
}

TEST(TrackFrames, FollowsARoverThatBacksUp) {
  const SyntheticRover rover =
      MakeSyntheticRover({.frames = 20, .step_m = -0.2, .pixel_sigma = kPixelSigma});
  const Odometry odometry = Track(rover);
  ExpectAllPosed(odometry);
  EXPECT_LT(WorstPosition_m(rover, odometry), kMaxPosition_m);
  EXPECT_LT(WorstTurn_rad(rover, odometry), kMaxTurn_rad);
}

TEST(TrackFrames, FollowsStopAndGo) {
  std::vector<Rigid3> path;
  for (int i = 0; i < 24; ++i) {
    const int moved = i < 6 ? i : i < 14 ? 6 : i - 8;
    path.push_back(RoverPose(0.2 * moved, 0.0, 0.0));
  }
  const SyntheticRover rover = Rover(path);
  const Odometry odometry = Track(rover);
  ExpectAllPosed(odometry);
  EXPECT_LT(WorstPosition_m(rover, odometry), kMaxPosition_m);
  int while_standing = 0;
  for (int i = 7; i < 14; ++i) while_standing += odometry[i].keyframe ? 1 : 0;
  EXPECT_LE(while_standing, 1);
}

// A frame that was bridged: between its neighbours and, by its own sigma, not far from the truth.
void ExpectBridged(const SyntheticRover& rover, const Odometry& odometry, int frame) {
  const OdometryFrame& bridged = odometry[frame];
  EXPECT_EQ(bridged.source, PoseSource::kPredicted);
  EXPECT_EQ(bridged.reference, frame - 1);
  EXPECT_FALSE(bridged.keyframe);
  const double sigma_m = std::sqrt(bridged.step_covariance(0, 0));
  EXPECT_GT(sigma_m, 0.01);
  EXPECT_LT(sigma_m, 0.2);
  EXPECT_LT(PositionError_m(rover, odometry, frame), sigma_m);
}

TEST(TrackFrames, BridgesABlackFrame) {
  SyntheticRover rover = MakeSyntheticRover({.frames = 16, .pixel_sigma = kPixelSigma});
  Blacken(rover.frames[8]);
  const Odometry odometry = Track(rover);
  ExpectBridged(rover, odometry, 8);
  EXPECT_EQ(odometry[9].source, PoseSource::kOdometry);
  EXPECT_LT(odometry[9].reference, 8);
  EXPECT_LT(PositionError_m(rover, odometry, 15), kMaxPosition_m);
}

TEST(TrackFrames, BridgesTwoBlackFrames) {
  SyntheticRover rover = MakeSyntheticRover({.frames = 16, .pixel_sigma = kPixelSigma});
  for (int frame : {7, 8}) Blacken(rover.frames[frame]);
  const Odometry odometry = Track(rover);
  for (int frame : {7, 8}) ExpectBridged(rover, odometry, frame);
  EXPECT_LT(odometry[9].reference, 7);
  EXPECT_LT(PositionError_m(rover, odometry, 15), kMaxPosition_m);
}

TEST(TrackFrames, BridgesFramesOfSomethingElse) {
  SeededRandom random;
  SyntheticRover rover = MakeSyntheticRover({.frames = 16, .pixel_sigma = kPixelSigma});
  for (int frame : {4, 8, 9}) Replace(rover.frames[frame], random);
  const Odometry odometry = Track(rover);
  for (int frame : {4, 8, 9}) ExpectBridged(rover, odometry, frame);
  EXPECT_LT(odometry[5].reference, 4);
  EXPECT_LT(odometry[10].reference, 8);
  EXPECT_LT(PositionError_m(rover, odometry, 15), kMaxPosition_m);
}

TEST(TrackFrames, GoesOnAfterAJump) {
  std::vector<Rigid3> path;
  for (int i = 0; i < 16; ++i) path.push_back(RoverPose(0.2 * i + (i < 8 ? 0.0 : 40.0), 0.0, 0.0));
  const SyntheticRover rover = Rover(path);
  const Odometry odometry = Track(rover);
  EXPECT_EQ(odometry[8].source, PoseSource::kPredicted);
  EXPECT_TRUE(odometry[8].keyframe);
  EXPECT_EQ(odometry[8].reference, 7);
  // As if the motion had gone on.
  EXPECT_NEAR(
      (odometry[8].world_from_left.translation - odometry[7].world_from_left.translation).norm(),
      0.2, 0.02);
  for (int i = 9; i < 16; ++i) {
    EXPECT_EQ(odometry[i].source, PoseSource::kOdometry);
    EXPECT_GE(odometry[i].reference, 8);
    const Rigid3 found = odometry[8].world_from_left.Inverse() * odometry[i].world_from_left;
    const Rigid3 truth = path[8].Inverse() * path[i];
    EXPECT_LT((found.translation - truth.translation).norm(), kMaxPosition_m);
  }
}

TEST(TrackFrames, FindsTheWayWhereFramesAreMissing) {
  // The motion goes on five times as fast for one step: outside the predicted radius.
  std::vector<Rigid3> path;
  for (int i = 0; i < 12; ++i) path.push_back(RoverPose(0.2 * i + (i < 6 ? 0.0 : 0.8), 0.0, 0.0));
  const SyntheticRover rover = Rover(path);
  const Odometry odometry = Track(rover);
  ExpectAllPosed(odometry);
  EXPECT_LT(WorstPosition_m(rover, odometry), kMaxPosition_m);
}

TEST(TrackFrames, ExpectedMotionStandsWhereTheMotionSoFarWould) {
  // A turn within one step, and descriptors of ten kinds: they tell points apart only near the
  // place where one is looked for.
  std::vector<Rigid3> path;
  for (int i = 0; i < 8; ++i) path.push_back(RoverPose(0.2 * i, 0.0, i < 5 ? 0.0 : 0.5));
  SyntheticRover rover = Rover(path);
  for (std::size_t f = 0; f < rover.frames.size(); ++f) {
    for (std::size_t k = 0; k < rover.point_of_feature[f].size(); ++k) {
      const int kind = rover.point_of_feature[f][k] % 10;
      rover.frames[f].descriptors[k].fill(static_cast<std::uint8_t>(25 * kind));
    }
  }
  const auto features = [&](int frame) { return rover.frames[frame]; };
  OdometryOptions options;
  options.search_radius_px = 4.0;
  const auto track = [&](const ExpectedMotion& expected) {
    return TrackFrames(8, features, rover.rig, options, MatchBy::kDescriptors, expected);
  };
  EXPECT_EQ(track({})[5].source, PoseSource::kPredicted);
  const Odometry odometry =
      track([&](int from, int to) { return path[to].Inverse() * path[from]; });
  ExpectAllPosed(odometry);
  EXPECT_LT(WorstPosition_m(rover, odometry), kMaxPosition_m);
}

TEST(TrackFrames, WhereNothingIsSeenTheExpectedMotionIsThePrediction) {
  std::vector<Rigid3> path;
  for (int i = 0; i < 8; ++i) path.push_back(RoverPose(0.2 * i, 0.0, i < 6 ? 0.0 : 0.3));
  SyntheticRover rover = Rover(path);
  for (int frame : {6, 7}) Blacken(rover.frames[frame]);
  const auto features = [&](int frame) { return rover.frames[frame]; };
  const Odometry odometry =
      TrackFrames(8, features, rover.rig, {}, MatchBy::kDescriptors,
                  [&](int from, int to) { return path[to].Inverse() * path[from]; });
  EXPECT_EQ(odometry[7].source, PoseSource::kPredicted);
  EXPECT_LT(WorstTurn_rad(rover, odometry), kMaxTurn_rad);
  EXPECT_LT(WorstPosition_m(rover, odometry), kMaxPosition_m);
}

TEST(TrackFrames, FewAndEmptyFrames) {
  SyntheticRover rover = MakeSyntheticRover({.frames = 4, .pixel_sigma = kPixelSigma});
  const auto features = [&](int frame) { return rover.frames[frame]; };
  EXPECT_TRUE(TrackFrames(0, features, rover.rig, {}).empty());
  EXPECT_EQ(TrackFrames(1, features, rover.rig, {}).size(), 1u);
  for (auto& frame : rover.frames) Blacken(frame);
  const Odometry dark = Track(rover);
  ASSERT_EQ(dark.size(), 4u);
  EXPECT_EQ(dark[0].source, PoseSource::kPredicted);
  for (int i = 1; i < 4; ++i) {
    EXPECT_EQ(dark[i].source, PoseSource::kPredicted);
    EXPECT_FALSE(dark[i].keyframe);
    // Nothing is known, and the sigma says so.
    EXPECT_GT(std::sqrt(dark[i].step_covariance(0, 0)), 0.05);
  }
}

// Of points so far that a disparity off in all alike falsifies their depths by more than a tenth.
TEST(TrackFrames, AWayAlongFarPointsIsKnownAsTheirDepthsAre) {
  const SyntheticRover rover = MakeSyntheticRover({.pixel_sigma = kPixelSigma});
  const auto share_of_way = [&](double disparity_noise_px) {
    const Odometry odometry = Track(rover, {.disparity_noise_px = disparity_noise_px});
    const Eigen::Vector3d way = OdometricStep(odometry, 1, 0).translation;
    return std::sqrt(way.dot(odometry[1].step_covariance.topLeftCorner<3, 3>() * way)) /
           way.squaredNorm();
  };
  EXPECT_LT(share_of_way(0.15), 0.03);
  EXPECT_GT(share_of_way(6.0), 0.1);
}

}  // namespace
}  // namespace rigmap
