#include "trajectory/assemble_trajectory.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/seeded_random.h"
#include "tests/trajectory/odometric_part.h"

namespace rigmap {
namespace {

TEST(AssembledTrajectory, HasEveryFrameWithItsSource) {
  Part part(4);
  part.odometry[2].keyframe = true;
  part.Predict(3, 4);
  part.Adjust(1, part.odometry[1].world_from_left, Diagonal(0.001, 0.001));
  const Trajectory trajectory = part.Assemble();
  ASSERT_EQ(trajectory.size(), 4U);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(trajectory[i].stamp_ns, part.odometry[i].stamp_ns);
  EXPECT_EQ(trajectory[1].source, PoseSource::kAdjusted);
  EXPECT_EQ(trajectory[2].source, PoseSource::kOdometry);
  EXPECT_EQ(trajectory[3].source, PoseSource::kPredicted);
  EXPECT_TRUE(trajectory[2].keyframe);
  EXPECT_FALSE(trajectory[3].keyframe);
}

TEST(AssembledTrajectory, KeepsAdjustedPosesAndHangsTheOthersOnThem) {
  Part part(4);
  SeededRandom random;
  const Rigid3 adjusted = random.Motion(1.0);
  part.Adjust(1, adjusted, Diagonal(0.002, 0.001));
  const Rigid3 world_from_gauge = random.Motion(1.0);
  const Trajectory trajectory = part.Assemble(world_from_gauge);
  ExpectSame(trajectory[1].world_from_left, world_from_gauge * adjusted);
  ExpectSame(trajectory[2].world_from_left, world_from_gauge * adjusted * part.Step(1, 2));
  ExpectSame(trajectory[3].world_from_left, world_from_gauge * adjusted * part.Step(1, 3));
  EXPECT_TRUE(trajectory[0].sigmas.isZero());
  EXPECT_NEAR(trajectory[1].sigmas[0], 0.002, 1e-12);
  EXPECT_NEAR(trajectory[1].sigmas[5], 0.001, 1e-12);
  EXPECT_GT(trajectory[2].sigmas.head<3>().minCoeff(), 0.002);
  EXPECT_GT(trajectory[3].sigmas.minCoeff(), trajectory[1].sigmas.minCoeff());
}

TEST(AssembledTrajectory, GivesSigmasAlongTheAxesOfTheWorld) {
  Part part(2);
  Matrix6d covariance = Matrix6d::Zero();
  covariance.diagonal() << 1e-2, 4e-2, 9e-2, 1e-4, 4e-4, 9e-4;
  part.Adjust(1, part.odometry[1].world_from_left, covariance);
  // x of the gauge is y of the world, y is -x.
  const Rigid3 world_from_gauge{ExpRotation({0.0, 0.0, std::acos(0.0)}), {5.0, 6.0, 7.0}};
  const Vector6d sigmas = part.Assemble(world_from_gauge)[1].sigmas;
  const Vector6d expected = (Vector6d() << 0.2, 0.1, 0.3, 0.02, 0.01, 0.03).finished();
  EXPECT_LT((sigmas - expected).norm(), 1e-12);
}

TEST(AssembledTrajectory, FramesThatStandStillStandWhereTheirReferenceDoes) {
  Part part(4);
  const Rigid3 adjusted{ExpRotation({0.1, -0.2, 0.3}), {0.4, 0.5, 0.6}};
  part.Adjust(1, adjusted, Diagonal(0.002, 0.001));
  for (const int still : {2, 3}) {
    part.odometry[still].reference = 1;
    part.odometry[still].stands_still = true;
    part.odometry[still].world_from_left = part.odometry[1].world_from_left;
  }
  const Trajectory trajectory = part.Assemble();
  for (const int still : {2, 3}) ExpectSame(trajectory[still].world_from_left, adjusted, 1e-12);
}

TEST(AssembledTrajectory, PredictedRunIsLaidOntoBothEnds) {
  Part part(8);
  part.Predict(2, 6);
  // The adjustment has turned and moved the end of the gap against the odometry.
  const Rigid3 end{part.odometry[6].world_from_left.rotation * ExpRotation({0.0, 0.1, 0.0}),
                   part.odometry[6].world_from_left.translation + Eigen::Vector3d(0.5, 0.2, -0.3)};
  part.Adjust(1, part.odometry[1].world_from_left, Diagonal(0.002, 0.001));
  part.Adjust(6, end, Diagonal(0.003, 0.001));
  const Trajectory trajectory = part.Assemble();
  ExpectSame(trajectory[6].world_from_left, end);
  // What the end was moved by is shared out: each step takes a fifth, the last one into the end
  // too.
  const Rigid3 moved = end * part.odometry[6].world_from_left.Inverse();
  for (int i = 2; i < 6; ++i) {
    const Rigid3 expected = Interpolate(Rigid3(), moved, (i - 1) / 5.0);
    ExpectSame(trajectory[i].world_from_left, expected * part.odometry[i].world_from_left);
  }
  // The first frame behind the gap hangs on the end.
  ExpectSame(trajectory[7].world_from_left, end * part.Step(6, 7));
}

TEST(AssembledTrajectory, SigmasOfAPredictedRunGrowInsideAndShrinkToItsEnds) {
  Part part(12);
  part.Predict(2, 10);
  part.Adjust(1, part.odometry[1].world_from_left, Diagonal(0.002, 0.001));
  part.Adjust(10, part.odometry[10].world_from_left, Diagonal(0.003, 0.001));
  const Trajectory trajectory = part.Assemble();
  const auto sigma = [&](int i) { return trajectory[i].sigmas.head<3>().norm(); };
  for (int i = 1; i < 5; ++i) EXPECT_LT(sigma(i), sigma(i + 1)) << i;
  for (int i = 6; i < 10; ++i) EXPECT_GT(sigma(i), sigma(i + 1)) << i;
  EXPECT_LT(trajectory[9].sigmas[3], 1.5 * std::hypot(0.001, kStepSigma_rad));
}

// Both ends of a gap err alike where what came before them errs.
TEST(AssembledTrajectory, SigmasOfAPredictedRunCountWhatItsEndsShareOnce) {
  Part part(8);
  part.Predict(4, 6);
  constexpr double kShared_m = 0.5;
  for (const int i : {3, 6}) {
    part.Adjust(i, part.odometry[i].world_from_left, Diagonal(kShared_m, 1e-5));
  }
  const Trajectory trajectory = part.Assemble();
  for (const int i : {4, 5}) {
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_GE(trajectory[i].sigmas[axis], kShared_m) << i;
      EXPECT_LT(trajectory[i].sigmas[axis], std::hypot(kShared_m, 2.0 * kStepSigma_m)) << i;
    }
  }
}

TEST(AssembledTrajectory, PredictedRunWithoutAnEndIsCarriedOnWithGrowingSigmas) {
  Part part(8);
  part.Predict(4, 8);
  const Trajectory trajectory = part.Assemble();
  for (int i = 4; i < 8; ++i) {
    ExpectSame(trajectory[i].world_from_left, part.odometry[i].world_from_left);
    EXPECT_GT(trajectory[i].sigmas.head<3>().norm(), trajectory[i - 1].sigmas.head<3>().norm());
  }
}

// A frame behind the gap that hangs on a predicted one knows nothing of the way across it.
TEST(AssembledTrajectory, RunIsNotTiedToAFrameThatHangsOnIt) {
  Part part(6);
  part.Predict(2, 4);
  part.odometry[4].reference = 3;
  part.Adjust(1, part.odometry[1].world_from_left, Diagonal(0.002, 0.001));
  const Trajectory trajectory = part.Assemble();
  for (int i = 2; i < 6; ++i) {
    ExpectSame(trajectory[i].world_from_left, part.odometry[i].world_from_left);
  }
  EXPECT_GT(trajectory[4].sigmas.norm(), trajectory[3].sigmas.norm());
}

// Position and rotation drawn with the covariance, about the axes of the gauge.
Rigid3 Draw(const Rigid3& pose, const Matrix6d& covariance, SeededRandom& random) {
  Vector6d draw;
  for (int i = 0; i < 6; ++i) draw[i] = random.Normal(1.0);
  const Vector6d error = covariance.llt().matrixL() * draw;
  return {ExpRotation(error.tail<3>()) * pose.rotation, pose.translation + error.head<3>()};
}

// A measured left_from_reference with an error drawn from its covariance, a left perturbation.
Rigid3 DrawStep(const Rigid3& left_from_reference, const Matrix6d& covariance,
                SeededRandom& random) {
  return Draw(Rigid3(), covariance, random) * left_from_reference;
}

Matrix6d RandomCovariance(double sigma_m, double sigma_rad, SeededRandom& random) {
  Matrix6d mixed;
  for (int i = 0; i < 36; ++i) mixed(i / 6, i % 6) = random.Normal(1.0);
  const Matrix6d scale = Diagonal(sigma_m, sigma_rad).cwiseSqrt();
  return scale * (mixed * mixed.transpose() / 6.0 + Matrix6d::Identity()) * scale;
}

// Spread of drawn poses about a mean: as TimedPose::sigmas.
class Spread {
 public:
  explicit Spread(Rigid3 mean) : mean_(std::move(mean)) {}
  void Add(const Rigid3& pose) {
    squares_.head<3>() += (pose.translation - mean_.translation).cwiseAbs2();
    squares_.tail<3>() += LogRotation(pose.rotation * mean_.rotation.conjugate()).cwiseAbs2();
    ++count_;
  }
  void ExpectSigmas(const Vector6d& sigmas) const {
    const Vector6d drawn = (squares_ / count_).cwiseSqrt();
    for (int i = 0; i < 6; ++i) EXPECT_NEAR(sigmas[i] / drawn[i], 1.0, 0.03) << i;
  }

 private:
  Rigid3 mean_;
  Vector6d squares_ = Vector6d::Zero();
  int count_ = 0;
};

constexpr int kDraws = 10000;  // leave 0.7 % on a sigma

// Conditioned on where its end was measured, by weighing drawn runs.
TEST(AssembledTrajectory, SigmasOfAPredictedRunAreThoseOfDrawnOnes) {
  Part part(6);
  SeededRandom random;
  part.Predict(2, 5);
  part.Adjust(1, part.odometry[1].world_from_left, Diagonal(0.004, 0.003));
  for (const int i : {2, 3, 4}) {
    part.odometry[i].step_covariance = Diagonal(0.02, 0.01);
  }
  part.odometry[5].step_covariance = Diagonal(0.04, 0.02);
  const Trajectory trajectory = part.Assemble();
  Vector6d squares = Vector6d::Zero();
  double weights = 0.0;
  const Rigid3 mean = part.odometry[3].world_from_left, end = part.odometry[5].world_from_left;
  for (int draw = 0; draw < 100000; ++draw) {
    const Rigid3 start =
        Draw(*part.adjustment.world_from_left[1], part.adjustment.covariances[1], random);
    Rigid3 pose = start, middle;
    for (const int i : {2, 3, 4, 5}) {
      const Matrix6d& step = part.odometry[std::min(i, 4)].step_covariance;
      pose = pose * DrawStep(part.Step(i - 1, i).Inverse(), step, random).Inverse();
      if (i == 3) middle = pose;
    }
    // The end as it was measured from the start, in the axes of the end.
    const Rigid3 measured = start * part.odometry[1].world_from_left.Inverse() * end;
    const Rigid3 off = pose.Inverse() * measured;
    const double square = off.translation.squaredNorm() / (0.04 * 0.04) +
                          LogRotation(off.rotation).squaredNorm() / (0.02 * 0.02);
    const double weight = std::exp(-0.5 * square);
    Vector6d error;
    error << middle.translation - mean.translation,
        LogRotation(middle.rotation * mean.rotation.conjugate());
    squares += weight * error.cwiseAbs2();
    weights += weight;
  }
  const Vector6d drawn = (squares / weights).cwiseSqrt();
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(trajectory[3].sigmas[i] / drawn[i], 1.0, 0.05) << i;
}

TEST(AssembledTrajectory, SigmasOfAChainOfStepsAreThoseOfDrawnOnes) {
  Part part(4);
  SeededRandom random;
  part.Adjust(1, random.Motion(1.0), RandomCovariance(0.004, 0.003, random));
  for (const int i : {2, 3})
    part.odometry[i].step_covariance = RandomCovariance(0.005, 0.004, random);
  const Trajectory trajectory = part.Assemble();
  Spread spread(trajectory[3].world_from_left);
  for (int draw = 0; draw < kDraws; ++draw) {
    Rigid3 pose = Draw(*part.adjustment.world_from_left[1], part.adjustment.covariances[1], random);
    for (const int i : {2, 3}) {
      pose =
          pose * DrawStep(part.Step(i - 1, i).Inverse(), part.odometry[i].step_covariance, random)
                     .Inverse();
    }
    spread.Add(pose);
  }
  spread.ExpectSigmas(trajectory[3].sigmas);
}

// Frames 3 and 4 share no point with those before: they are known relative to frame 2, which only
// odometry ties to the rest.
TEST(AssembledTrajectory, SigmasBehindADatumFrameTakeInThoseOfTheDatumFrame) {
  Part part(5);
  SeededRandom random;
  part.Adjust(1, part.odometry[1].world_from_left, RandomCovariance(0.004, 0.003, random));
  part.Adjust(2, part.odometry[2].world_from_left, Matrix6d::Zero(), 2);
  for (const int i : {3, 4}) {
    const Rigid3 pose = part.odometry[i].world_from_left;
    part.Adjust(i, pose, RandomCovariance(0.002, 0.001, random), 2);
  }
  const Trajectory trajectory = part.Assemble();
  Spread of_datum_frame(trajectory[2].world_from_left), of_last(trajectory[4].world_from_left);
  for (int draw = 0; draw < kDraws; ++draw) {
    const Rigid3 before =
        Draw(*part.adjustment.world_from_left[1], part.adjustment.covariances[1], random);
    const Rigid3 datum_frame =
        before *
        DrawStep(part.Step(1, 2).Inverse(), part.odometry[2].step_covariance, random).Inverse();
    of_datum_frame.Add(datum_frame);
    const Rigid3 last =
        Draw(*part.adjustment.world_from_left[4], part.adjustment.covariances[4], random);
    of_last.Add(datum_frame * part.odometry[2].world_from_left.Inverse() * last);
  }
  of_datum_frame.ExpectSigmas(trajectory[2].sigmas);
  of_last.ExpectSigmas(trajectory[4].sigmas);
}

// A wrong focal length stretches both groups alike: their errors add up, not their squares.
TEST(AssembledTrajectory, GroupsShareTheErrorOfTheCalibration) {
  Part part(5);
  const double sigma = 0.01;
  part.adjustment.calibration_covariance(kLogFocal, kLogFocal) = sigma * sigma;
  part.adjustment.by_calibration.assign(5, PoseCalibration::Zero());
  const auto stretch = [&](int frame, int datum_frame) {
    const Rigid3& pose = part.odometry[frame].world_from_left;
    part.adjustment.by_calibration[frame].col(kLogFocal).head<3>() =
        pose.translation - part.odometry[datum_frame].world_from_left.translation;
    const PoseCalibration& by = part.adjustment.by_calibration[frame];
    part.Adjust(frame, pose, by * part.adjustment.calibration_covariance * by.transpose(),
                datum_frame);
  };
  for (OdometryFrame& frame : part.odometry) frame.step_covariance.setZero();
  for (const int frame : {1, 2}) stretch(frame, 0);
  part.Adjust(3, part.odometry[3].world_from_left, Matrix6d::Zero(), 3);
  stretch(4, 3);
  const Trajectory trajectory = part.Assemble();
  // But for the step between the groups, of which the odometry knows no such error.
  const Eigen::Vector3d stretched = part.odometry[2].world_from_left.translation +
                                    part.odometry[4].world_from_left.translation -
                                    part.odometry[3].world_from_left.translation;
  EXPECT_LT((trajectory[4].sigmas.head<3>() - sigma * stretched.cwiseAbs()).norm(), 1e-9);
}

}  // namespace
}  // namespace rigmap
