#include "dead_reckoning/internal/rover_state.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "dead_reckoning/internal/measurements.h"
#include "tests/dead_reckoning/driven_rover.h"
#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

constexpr double kSmall = 1e-5, kTolerance = 1e-3;  // of derivatives by differences

class RoverStateTest : public testing::Test {
 protected:
  RoverStateTest() {
    state_.gauge_from_left = random_.Motion(2.0);
    state_.up_in_gauge = random_.Rotation() * Eigen::Vector3d::UnitZ();
    state_.values.segment<3>(kGyroBias) = random_.Vector(0.01);
    state_.values.segment<2>(kTravel) = random_.Vector(0.02).head<2>();
    state_.values(kWheelScale) = 0.03;
    state_.values(kGyroScale) = 0.01;
    for (int i = 0; i < 50; ++i) {
      steps_.push_back({0.008, random_.Vector(0.3), random_.Uniform(0.0, 0.004)});
    }
  }
  RoverModel Model() const {
    const StereoRig& rig = rover_.dataset.rig;
    return {*rig.imu_from_left, ContactInImu(rig, options_), options_, {}};
  }
  StateVector Unit(int i) const { return kSmall * StateVector::Unit(i); }

  SeededRandom random_;
  DeadReckoningOptions options_;
  DrivenRover rover_ = DriveRover(2, [](double) { return Drive(); });
  RoverState state_;
  SensorSteps steps_;
};

TEST_F(RoverStateTest, ErrorBetweenIsTheInverseOfCorrected) {
  StateVector error = StateVector::Random() * 0.01;
  const RoverState corrected = Corrected(state_, error);
  // A turn about the up direction itself changes nothing.
  error.segment<3>(kUp) -= error.segment<3>(kUp).dot(state_.up_in_gauge) * state_.up_in_gauge;
  StateVector found = ErrorBetween(corrected, state_);
  found.segment<3>(kUp) -= found.segment<3>(kUp).dot(state_.up_in_gauge) * state_.up_in_gauge;
  EXPECT_LT((found - error).norm(), 1e-3);
}

TEST_F(RoverStateTest, TransitionIsTheDerivativeOfTheMotion) {
  const Prediction prediction = Predict(state_, steps_, {}, Model());
  for (int i = 0; i < kStateSize; ++i) {
    if (i >= kUp && i < kUp + 3) continue;
    const Prediction moved = Predict(Corrected(state_, Unit(i)), steps_, {}, Model());
    const StateVector column = ErrorBetween(moved.state, prediction.state) / kSmall;
    EXPECT_LT((column - prediction.transition.col(i)).norm(), kTolerance) << "of state " << i;
  }
}

TEST_F(RoverStateTest, NoiseGrowsWithTheWay) {
  const Prediction once = Predict(state_, steps_, {}, Model());
  SensorSteps twice = steps_;
  twice.insert(twice.end(), steps_.begin(), steps_.end());
  const Prediction longer = Predict(state_, twice, {}, Model());
  EXPECT_GT(longer.noise(0, 0), 1.5 * once.noise(0, 0));
  EXPECT_EQ(Matrix6d(once.noise.topLeftCorner<6, 6>()).llt().info(), Eigen::Success);
}

TEST_F(RoverStateTest, WithoutAWheelTheRoverGoesOnButUnsurely) {
  for (SensorStep& step : steps_) step.way_m.reset();
  const Prediction prediction = Predict(state_, steps_, {.speed_mps = 0.2}, Model());
  EXPECT_NEAR(prediction.way_in_gauge.norm(), 0.08 * std::exp(0.03), 2e-3) << "m";
  EXPECT_GT(std::sqrt(prediction.noise.topLeftCorner<3, 3>().trace()), 0.15) << "m";
}

class MeasurementsTest : public RoverStateTest {
 protected:
  MeasurementsTest() {
    belief_.rover = state_;
    belief_.clones = {{3, random_.Motion(1.0, 0.5)}, {5, random_.Motion(1.0, 0.5)}};
    belief_.covariance = Eigen::MatrixXd::Identity(belief_.Size(), belief_.Size());
  }
  // The jacobian says how the residual answers to errors of the belief.
  template <class Measure>
  void ExpectDerivative(const Measure& measure) {
    const Measurement measurement = measure(belief_);
    for (int i = 0; i < belief_.Size(); ++i) {
      const Eigen::VectorXd error = kSmall * Eigen::VectorXd::Unit(belief_.Size(), i);
      const Eigen::VectorXd change =
          (measurement.residual - measure(Corrected(belief_, error)).residual) / kSmall;
      EXPECT_LT((change - measurement.jacobian.col(i)).norm(), 0.02) << "of error " << i;
    }
  }
  Belief belief_;
};

TEST_F(MeasurementsTest, InclinationIsLinearised) {
  ExpectDerivative([&](const Belief& belief) {
    return InclinationOf(belief, random_.Rotation(0.0) * Eigen::Vector3d(0.3, 0.2, 9.8), Model());
  });
}

TEST_F(MeasurementsTest, BiasAtRestIsLinearised) {
  ExpectDerivative([&](const Belief& belief) {
    return BiasAtRest(belief, {{0.01, 0.0, 0.0}, 2.0}, Model());
  });
}

TEST_F(MeasurementsTest, VisualMotionIsLinearisedNearTheTruth) {
  VisualStep step{5, 7};
  // Off by millimetres and milliradians, as the filter finds it.
  step.to_from_from = Rigid3{ExpRotation(random_.Vector(0.002)), random_.Vector(0.003)} *
                      state_.gauge_from_left.Inverse() * belief_.clones[1].gauge_from_left;
  ExpectDerivative([&](const Belief& belief) { return VisualMotionOf(belief, step, 1.0); });
  EXPECT_LT(VisualMotionOf(belief_, step, 1.0).residual.norm(), 0.02);
}

}  // namespace
}  // namespace rigmap
