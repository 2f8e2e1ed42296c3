#include "trajectory/motion_model.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

constexpr StampNs kSecond = 1'000'000'000;

// A frame per second, each moved against the one before by the same motion in its own axes.
Odometry Carried(const Rigid3& start, const Rigid3& motion, int count) {
  Odometry odometry;
  Rigid3 pose = start;
  for (int i = 0; i < count; ++i) {
    odometry.push_back({.stamp_ns = i * kSecond, .world_from_left = pose});
    odometry.back().reference = std::max(0, i - 1);
    odometry.back().source = PoseSource::kOdometry;
    pose = pose * motion;
  }
  return odometry;
}

double PoseDistance(const Rigid3& a, const Rigid3& b) {
  return (a.translation - b.translation).norm() + AngleOf(a.rotation.conjugate() * b.rotation);
}

TEST(PredictPose, GoesOnAsBefore) {
  SeededRandom random;
  for (int trial = 0; trial < 20; ++trial) {
    const Rigid3 motion{random.Rotation(0.3), random.Vector(0.5)};
    const Odometry odometry = Carried(random.Motion(5.0), motion, 4);
    const Rigid3& last = odometry.back().world_from_left;
    EXPECT_LT(PoseDistance(PredictPose(odometry, 4 * kSecond), last * motion), 1e-12);
    EXPECT_LT(PoseDistance(PredictPose(odometry, 3 * kSecond), last), 1e-12);
  }
}

TEST(PredictPose, GoesTwiceAsFarInTwiceTheTime) {
  SeededRandom random;
  const Rigid3 motion{Eigen::Quaterniond::Identity(), random.Vector(0.5)};
  const Odometry odometry = Carried(random.Motion(5.0), motion, 3);
  EXPECT_LT(PoseDistance(PredictPose(odometry, 4 * kSecond),
                         odometry.back().world_from_left * motion * motion),
            1e-12);
}

TEST(PredictPose, DoesNotDependOnTheWorld) {
  SeededRandom random;
  const Rigid3 motion{random.Rotation(0.3), random.Vector(0.5)};
  const Rigid3 other_from_world = random.Motion(9.0);
  const Rigid3 start = random.Motion(5.0);
  const Rigid3 a = PredictPose(Carried(start, motion, 3), 5 * kSecond);
  const Rigid3 b = PredictPose(Carried(other_from_world * start, motion, 3), 5 * kSecond);
  EXPECT_LT(PoseDistance(other_from_world * a, b), 1e-9);
}

TEST(PredictPose, StaysWhereThereIsNoMotionToCarryOn) {
  SeededRandom random;
  const Rigid3 start = random.Motion(5.0);
  EXPECT_EQ(PoseDistance(PredictPose(Carried(start, Rigid3(), 1), 7 * kSecond), start), 0.0);
}

constexpr UnmeasuredMotion kUnmeasured{0.3, 0.1};

TEST(SetPredictionCovariances, AllowsSpeedAndTurnRateToChange) {
  const Rigid3 motion{Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.5}};
  Odometry odometry = Carried({}, motion, 4);
  odometry[2].source = PoseSource::kPredicted;
  odometry[1].step_covariance = 7.0 * Matrix6d::Identity();
  SetPredictionCovariances(odometry, kUnmeasured);
  const Vector6d sigmas = odometry[2].step_covariance.diagonal().cwiseSqrt();
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(sigmas(i), 0.5 * kUnmeasured.speed_change_share, 1e-12);
    EXPECT_NEAR(sigmas(3 + i), kUnmeasured.turn_change_rad_per_s, 1e-12);
  }
  EXPECT_EQ(odometry[1].step_covariance, 7.0 * Matrix6d::Identity());  // was measured
  EXPECT_EQ(odometry[3].step_covariance, Matrix6d::Zero());
}

// One change of speed lasts: ten times as many frames know no more.
TEST(SetPredictionCovariances, GrowWithTheGapNotWithItsFrames) {
  const auto variance_of_gap = [](int frames, StampNs step_ns) {
    const double step_m = 0.5e-9 * static_cast<double>(step_ns);
    Odometry odometry = Carried({}, {Eigen::Quaterniond::Identity(), {0.0, 0.0, step_m}}, frames);
    for (int i = 0; i < frames; ++i) {
      odometry[i].stamp_ns = i * step_ns;
      if (i > 1) odometry[i].source = PoseSource::kPredicted;
    }
    SetPredictionCovariances(odometry, kUnmeasured);
    Matrix6d sum = Matrix6d::Zero();
    for (const OdometryFrame& frame : odometry) sum += frame.step_covariance;
    return Vector6d(sum.diagonal());
  };
  const Vector6d slow = variance_of_gap(4, kSecond), fast = variance_of_gap(22, kSecond / 10);
  EXPECT_LT((fast - slow).norm(), 1e-9 * slow.norm());
  EXPECT_NEAR(std::sqrt(slow(0)), 2.0 * 0.5 * kUnmeasured.speed_change_share, 1e-9);
  EXPECT_NEAR(std::sqrt(slow(5)), 2.0 * kUnmeasured.turn_change_rad_per_s, 1e-9);
}

TEST(SetPredictionCovariances, KnowsThatAStandingRigMayStart) {
  const Rigid3 motion{Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.5}};
  Odometry odometry = Carried({}, Rigid3(), 3);
  odometry[2].source = PoseSource::kPredicted;
  SetPredictionCovariances(odometry, kUnmeasured);
  EXPECT_GT(odometry[2].step_covariance.diagonal().minCoeff(), 0.0);
  // What it did later tells how fast it is.
  for (OdometryFrame frame : Carried({}, motion, 3)) {
    frame.stamp_ns += 3 * kSecond;
    odometry.push_back(frame);
  }
  SetPredictionCovariances(odometry, kUnmeasured);
  EXPECT_NEAR(std::sqrt(odometry[2].step_covariance(0, 0)), 0.5 * kUnmeasured.speed_change_share,
              1e-12);
}

TEST(BridgePredicted, PutsThemBetweenTheirNeighboursByTime) {
  SeededRandom random;
  Odometry odometry = Carried(random.Motion(3.0), {random.Rotation(0.2), random.Vector(0.5)}, 6);
  const Odometry truth = odometry;
  for (int i : {2, 3}) {
    odometry[i].source = PoseSource::kPredicted;
    odometry[i].world_from_left = random.Motion(5.0);
  }
  odometry[3].stamp_ns += kSecond / 2;
  odometry[4].reference = 1;
  BridgePredicted(odometry);
  const Rigid3 &from = truth[1].world_from_left, &to = truth[4].world_from_left;
  EXPECT_LT(PoseDistance(odometry[2].world_from_left, Interpolate(from, to, 1.0 / 3.0)), 1e-9);
  EXPECT_LT(PoseDistance(odometry[3].world_from_left, Interpolate(from, to, 2.5 / 3.0)), 1e-9);
  for (int i : {0, 1, 4, 5}) {
    EXPECT_EQ(PoseDistance(odometry[i].world_from_left, truth[i].world_from_left), 0.0) << i;
  }
  const Odometry once = odometry;
  BridgePredicted(odometry);
  for (int i = 0; i < 6; ++i) {
    EXPECT_LT(PoseDistance(odometry[i].world_from_left, once[i].world_from_left), 1e-12);
  }
}

TEST(BridgePredicted, LeavesGapsThatNothingMeasuredAcross) {
  SeededRandom random;
  Odometry odometry = Carried({}, {random.Rotation(0.2), random.Vector(0.5)}, 6);
  odometry[2].source = PoseSource::kPredicted;  // frame 3 hangs on it
  odometry[5].source = PoseSource::kPredicted;  // nothing comes after
  const Odometry before = odometry;
  BridgePredicted(odometry);
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(PoseDistance(odometry[i].world_from_left, before[i].world_from_left), 0.0) << i;
  }
}

}  // namespace
}  // namespace rigmap
