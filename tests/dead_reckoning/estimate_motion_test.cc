#include "dead_reckoning/estimate_motion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/dead_reckoning/driven_rover.h"
#include "tests/support/message_of.h"
#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Drive Meander(double time_s) { return {0.2, 0.2 * std::sin(0.4 * time_s)}; }

double OffM(const EstimatedMotion& motion, const DrivenRover& rover, std::size_t frame) {
  return (motion.poses[frame].gauge_from_left.translation -
          rover.gauge_from_left[frame].translation)
      .norm();
}

double SigmaM(const EstimatedMotion& motion, std::size_t frame) {
  return std::sqrt(motion.poses[frame].covariance.topLeftCorner<3, 3>().trace());
}

// All wheels turn farther by a share between two frames.
void Slip(int first, int end, double share, Dataset& dataset) {
  const StampNs begin_ns = dataset.frames[first].stamp_ns, end_ns = dataset.frames[end].stamp_ns;
  auto& samples = dataset.wheels.samples;
  std::array<double, 6> more{};
  auto before = samples.front().drive_angle_rad;
  for (WheelSample& sample : samples) {
    const auto angles = sample.drive_angle_rad;
    for (std::size_t i = 0; i < 6; ++i) {
      if (sample.stamp_ns > begin_ns && sample.stamp_ns <= end_ns) {
        more[i] += share * (angles[i] - before[i]);
      }
      sample.drive_angle_rad[i] += more[i];
    }
    before = angles;
  }
}

std::vector<VisualStep> AllSteps(const DrivenRover& rover) {
  std::vector<VisualStep> steps;
  for (int i = 1; i < static_cast<int>(rover.gauge_from_left.size()); ++i) {
    steps.push_back(TrueStep(rover, i - 1, i));
  }
  return steps;
}

class EstimateMotionTest : public testing::Test {
 protected:
  EstimatedMotion ByWheels() const {
    return EstimateMotion(rover_.dataset, {}, WithoutSlip(), FilterOptions());
  }
  EstimatedMotion Filtered(const std::vector<VisualStep>& steps) const {
    return EstimateMotion(rover_.dataset, steps, WithoutSlip(), filter_);
  }
  std::string Complaint() const {
    return MessageOf<DataError>([&] { ByWheels(); });
  }
  DrivenRover rover_ = DriveRover(30, Meander);
  FilterOptions filter_;
};

TEST_F(EstimateMotionTest, SensorsWithoutErrorGiveTheTruth) {
  const EstimatedMotion motion = ByWheels();
  ASSERT_EQ(motion.poses.size(), 30U);
  for (std::size_t i = 0; i < motion.poses.size(); ++i) EXPECT_LT(OffM(motion, rover_, i), 2e-3);
  EXPECT_NEAR(motion.wheel_scale, 1.0, 1e-6);
}

TEST_F(EstimateMotionTest, ATurnOnTheSpotSwaysTheCamera) {
  rover_ = DriveRover(8, [](double) { return Drive{0.0, 0.3}; });
  const EstimatedMotion motion = ByWheels();
  EXPECT_GT(rover_.gauge_from_left.back().translation.norm(), 0.5) << "m";
  EXPECT_LT(OffM(motion, rover_, 7), 2e-3) << "m";
}

TEST_F(EstimateMotionTest, ABiasIsFoundAtRest) {
  const Eigen::Vector3d bias(0.003, -0.002, 0.004);
  for (InertialSample& sample : rover_.dataset.inertial.samples) sample.angular_rate_radps += bias;
  const EstimatedMotion motion = ByWheels();
  EXPECT_LT((motion.gyro_bias_radps - bias).norm(), 4e-4) << "rad/s";
  EXPECT_LT(OffM(motion, rover_, 29), 0.05) << "m, of 5.8";
}

TEST_F(EstimateMotionTest, SigmasGrowAlongTheWay) {
  rover_ = DriveRover(10, [](double) { return Drive{0.2, 0.0}; });
  const EstimatedMotion motion = ByWheels();
  EXPECT_LT(SigmaM(motion, 0), 1e-4);
  for (std::size_t i = 2; i < motion.poses.size(); ++i) {
    EXPECT_GT(SigmaM(motion, i), SigmaM(motion, i - 1));
  }
}

TEST_F(EstimateMotionTest, WheelsOfAnotherSizeAreWithinTheirSigma) {
  Slip(0, 29, 0.03, rover_.dataset);
  const EstimatedMotion motion = ByWheels();
  EXPECT_GT(OffM(motion, rover_, 29), 0.1) << "m";
  EXPECT_LT(OffM(motion, rover_, 29), 2.0 * SigmaM(motion, 29));
}

TEST_F(EstimateMotionTest, VisionTellsTheSizeOfTheWheels) {
  Slip(0, 29, 0.03, rover_.dataset);
  const EstimatedMotion motion = Filtered(AllSteps(rover_));
  EXPECT_LT(motion.wheel_scale_sigma, 0.7 * WithoutSlip().wheel_scale_sigma);
  EXPECT_NEAR(motion.wheel_scale, 1.0 / 1.03, motion.wheel_scale_sigma);
  EXPECT_LT(OffM(motion, rover_, 29), 0.01) << "m";
  EXPECT_THAT(motion.slips, IsEmpty());
}

TEST_F(EstimateMotionTest, ABurstOfSlipIsFoundAndPassedOver) {
  Slip(12, 15, 0.6, rover_.dataset);
  const EstimatedMotion motion = Filtered(AllSteps(rover_));
  EXPECT_THAT(motion.slips, ElementsAre(13, 14, 15));
  EXPECT_THAT(motion.misled, IsEmpty());
  EXPECT_LT(OffM(motion, rover_, 29), 0.01) << "m";
}

TEST_F(EstimateMotionTest, VisualMotionThatNothingBearsOutIsNotUsed) {
  std::vector<VisualStep> steps = AllSteps(rover_);
  steps[14].to_from_from.translation += Eigen::Vector3d(1.5, 0.0, 0.5);
  const EstimatedMotion motion = Filtered(steps);
  EXPECT_THAT(motion.misled, ElementsAre(15));
  EXPECT_LT(OffM(motion, rover_, 29), 0.03) << "m";
}

TEST_F(EstimateMotionTest, AStretchWithoutImagesIsBridged) {
  std::vector<VisualStep> steps = AllSteps(rover_);
  std::erase_if(steps, [](const VisualStep& step) { return step.to > 10 && step.to <= 20; });
  const EstimatedMotion seen = Filtered(AllSteps(rover_)), motion = Filtered(steps);
  EXPECT_LT(OffM(motion, rover_, 29), 0.02) << "m";
  EXPECT_GT(SigmaM(motion, 20), 1.5 * SigmaM(seen, 20));
  EXPECT_TRUE(motion.poses[15].is_measured) << "by wheels and gyro";
}

TEST_F(EstimateMotionTest, WhatNothingMeasuresIsSaid) {
  std::vector<VisualStep> steps = AllSteps(rover_);
  std::erase_if(steps, [](const VisualStep& step) { return step.to == 11; });
  filter_.use_wheels = false;
  const EstimatedMotion motion = Filtered(steps);
  EXPECT_TRUE(motion.poses[10].is_measured);
  EXPECT_FALSE(motion.poses[11].is_measured);
}

TEST_F(EstimateMotionTest, VisionAloneIsFollowedWhereNothingElseIsUsed) {
  filter_.use_wheels = filter_.use_gyro = filter_.use_inclinometer = false;
  rover_.dataset.wheels = {};
  rover_.dataset.inertial = {};
  const EstimatedMotion motion = Filtered(AllSteps(rover_));
  EXPECT_LT(OffM(motion, rover_, 29), 1e-3) << "m";
}

TEST_F(EstimateMotionTest, ASharpTurnIsFollowedByVisionAlone) {
  rover_ = DriveRover(12, [](double time_s) {
    return time_s < 5.0 || time_s > 6.0 ? Drive{0.2, 0.0} : Drive{0.0, 1.2};
  });
  filter_.use_wheels = filter_.use_gyro = filter_.use_inclinometer = false;
  const EstimatedMotion motion = Filtered(AllSteps(rover_));
  EXPECT_THAT(motion.misled, IsEmpty());
  EXPECT_LT(OffM(motion, rover_, 11), 0.01) << "m";
}

// A drive whose sensors are off as the options have them.
DrivenRover NoisyDrive(const DeadReckoningOptions& options, SeededRandom& random) {
  DrivenRover rover = DriveRover(20, Meander);
  Slip(0, 19, random.Normal(options.wheel_scale_sigma), rover.dataset);
  const Eigen::Vector3d bias = random.Noise(options.gyro_bias_sigma_radps);
  const double gyro_scale = 1.0 + random.Normal(options.gyro_scale_sigma);
  for (InertialSample& sample : rover.dataset.inertial.samples) {
    const bool drives = sample.stamp_ns > rover.dataset.frames.front().stamp_ns;
    const double density = drives ? options.gyro_driving_noise_radps : options.gyro_noise_radps;
    sample.angular_rate_radps =
        gyro_scale * sample.angular_rate_radps + bias + random.Noise(density / std::sqrt(0.008));
  }
  for (InclinometerSample& sample : rover.dataset.inclinometer) {
    sample.acceleration_in_imu += 9.81 * random.Noise(options.inclinometer_sigma_rad);
  }
  return rover;
}

// Of position and rotation.
Vector6d ErrorOf(const EstimatedMotion& motion, const DrivenRover& rover, std::size_t frame) {
  const Rigid3 &truth = rover.gauge_from_left[frame], &found = motion.poses[frame].gauge_from_left;
  Vector6d off;
  off << truth.translation - found.translation,
      LogRotation(truth.rotation * found.rotation.conjugate());
  return off;
}

// Errors drawn as the options have them are as large as the covariances say.
TEST_F(EstimateMotionTest, SigmasAreHonest) {
  constexpr int kDrives = 40;
  const DeadReckoningOptions options = WithoutSlip();
  SeededRandom random;
  double squared = 0.0;
  for (int i = 0; i < kDrives; ++i) {
    const DrivenRover rover = NoisyDrive(options, random);
    const auto motion = EstimateMotion(rover.dataset, {}, options, FilterOptions());
    const Vector6d error = ErrorOf(motion, rover, 19);
    squared += error.dot(motion.poses[19].covariance.ldlt().solve(error)) / 6.0 / kDrives;
  }
  // Slip from metre to metre, contact point and direction of travel are without error here.
  EXPECT_GT(squared, 0.3);
  EXPECT_LT(squared, 1.2);
}

// With images as noisy as they say, three seconds of slip and, in every second drive, none seen
// for five seconds at another time.
TEST_F(EstimateMotionTest, FilteredPosesLieWithinTheirSigmasThroughBurstsAndGaps) {
  constexpr int kDrives = 30;
  const DeadReckoningOptions options = WithoutSlip();
  filter_.vision_scale_sigma = 0.0;
  SeededRandom random;
  int within_three = 0, poses = 0;
  double squared = 0.0;
  for (int i = 0; i < kDrives; ++i) {
    DrivenRover rover = NoisyDrive(options, random);
    Slip(4, 7, random.Uniform(0.3, 0.6), rover.dataset);
    std::vector<VisualStep> steps = AllSteps(rover);
    for (VisualStep& step : steps) {
      const Vector6d sigmas = step.covariance.diagonal().cwiseSqrt();
      const Rigid3 noise{ExpRotation(random.Noise(sigmas[3])), random.Noise(sigmas[0])};
      step.to_from_from = noise * step.to_from_from;
    }
    if (i % 2 == 0) {
      std::erase_if(steps, [](const VisualStep& step) { return step.to > 11 && step.to <= 16; });
    }
    const EstimatedMotion motion = EstimateMotion(rover.dataset, steps, options, filter_);
    for (std::size_t frame = 1; frame < motion.poses.size(); ++frame) {
      const Vector6d over =
          ErrorOf(motion, rover, frame)
              .cwiseQuotient(motion.poses[frame].covariance.diagonal().cwiseSqrt());
      within_three += over.cwiseAbs().maxCoeff() <= 3.0 ? 1 : 0;
      squared += over.squaredNorm() / 6.0;
      ++poses;
    }
  }
  EXPECT_GE(within_three, 0.97 * poses);
  EXPECT_GT(squared / poses, 0.3) << "sigmas are not merely large";
}

TEST_F(EstimateMotionTest, ARigWithoutAnImuIsRefused) {
  rover_.dataset.rig.imu_from_left.reset();
  rover_.dataset.rig.source = "rig.yaml";
  EXPECT_THAT(Complaint(), HasSubstr("rig.yaml: expected imu_from_left"));
}

TEST_F(EstimateMotionTest, ProblemsOfTheSensorsAreTold) {
  rover_.dataset.wheels.problem = "odometry.txt: expected this, found that";
  EXPECT_EQ(Complaint(), "odometry.txt: expected this, found that");
}

TEST_F(EstimateMotionTest, WheelsCannotBridgeAGap) {
  const StampNs begin_ns = rover_.dataset.frames[4].stamp_ns;
  std::erase_if(rover_.dataset.wheels.samples, [&](const WheelSample& sample) {
    return sample.stamp_ns > begin_ns && sample.stamp_ns < begin_ns + 1'000'000'000;
  });
  EXPECT_THAT(Complaint(), AllOf(HasSubstr("odometry.txt: expected rows at least every 0.5 s"),
                                 HasSubstr("found none for 1.04 s, 4.00 s after the first")));
  EXPECT_LT(OffM(Filtered(AllSteps(rover_)), rover_, 29), 0.01) << "m: images bridge it";
}

TEST(VisualSteps, LeadForwardsInTime) {
  SeededRandom random;
  Odometry odometry(3);
  for (int i = 0; i < 3; ++i) {
    odometry[i].world_from_left = random.Motion(1.0);
    odometry[i].step_covariance = Matrix6d::Identity();
    odometry[i].source = PoseSource::kOdometry;
  }
  // The second frame was the first that others could be posed against.
  odometry[0].reference = odometry[1].reference = odometry[2].reference = 1;
  const auto steps = VisualSteps(odometry);
  ASSERT_EQ(steps.size(), 2U);
  for (const VisualStep& step : steps) {
    EXPECT_LT(step.from, step.to);
    const Rigid3 off = odometry[step.to].world_from_left * step.to_from_from *
                       odometry[step.from].world_from_left.Inverse();
    EXPECT_LT(off.translation.norm() + AngleOf(off.rotation), 1e-9);
  }
}

}  // namespace
}  // namespace rigmap
