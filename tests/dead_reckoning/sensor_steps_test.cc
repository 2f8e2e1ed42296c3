#include "dead_reckoning/internal/sensor_steps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/dead_reckoning/driven_rover.h"

namespace rigmap {
namespace {

constexpr StampNs kSecondNs = 1'000'000'000;

class SensorStepsTest : public testing::Test {
 protected:
  double Way(const StereoRig& rig) const {
    const auto& frames = rover_.dataset.frames;
    return *WheelWay(rover_.dataset.wheels, rig, WithoutSlip())
                .Between(frames[2].stamp_ns, frames[5].stamp_ns);
  }
  DrivenRover rover_ = DriveRover(8, [](double) { return Drive{0.2, 0.15}; });
  WheelWay way_{rover_.dataset.wheels, rover_.dataset.rig, WithoutSlip()};
};

TEST_F(SensorStepsTest, TheMiddleAxleRollsAsFarAsTheContactPoint) {
  EXPECT_NEAR(Way(rover_.dataset.rig), 0.6, 1e-9) << "m";
}

TEST_F(SensorStepsTest, SteeredWheelsCountByTheCosineOfTheirAngle) {
  StereoRig rig = rover_.dataset.rig;
  rig.wheels = SixWheels();
  EXPECT_NEAR(Way(rig), 0.6, 1e-4) << "m";
  for (RoverWheel& wheel : rig.wheels->wheels) wheel.steering.reset();
  EXPECT_GT(Way(rig), 0.61) << "m: as if they were not steered";
}

TEST_F(SensorStepsTest, TheRigsRadiusComesBeforeTheOption) {
  StereoRig rig = rover_.dataset.rig;
  rig.wheels = SixWheels();
  rig.wheels->radius_m = 0.246;
  EXPECT_NEAR(Way(rig), 1.2, 2e-4) << "m";
}

TEST_F(SensorStepsTest, SlipShortensTheWay) {
  DeadReckoningOptions options;
  options.wheel_slip = 0.25;
  const auto& frames = rover_.dataset.frames;
  const WheelWay way(rover_.dataset.wheels, rover_.dataset.rig, options);
  EXPECT_NEAR(*way.Between(frames[2].stamp_ns, frames[5].stamp_ns), 0.48, 1e-9) << "m";
}

TEST_F(SensorStepsTest, StepsAddUpToTheSpan) {
  const auto& frames = rover_.dataset.frames;
  const StampNs begin_ns = frames[1].stamp_ns + 3'000'001, end_ns = frames[3].stamp_ns + 7;
  double duration_s = 0.0, way_m = 0.0, turned_rad = 0.0;
  for (const SensorStep& step :
       CutSteps(begin_ns, end_ns, rover_.dataset.inertial.samples, way_, WithoutSlip())) {
    duration_s += step.duration_s;
    way_m += step.way_m.value();
    turned_rad += step.duration_s * step.turn_rate_radps.value().z();
  }
  const double span_s = 1e-9 * static_cast<double>(end_ns - begin_ns);
  EXPECT_NEAR(duration_s, span_s, 1e-9) << "s";
  EXPECT_NEAR(way_m, 0.2 * span_s, 1e-9) << "m";
  EXPECT_NEAR(turned_rad, 0.15 * span_s, 1e-9) << "rad";
}

TEST_F(SensorStepsTest, AcrossAGapNothingIsMeasured) {
  auto& inertial = rover_.dataset.inertial.samples;
  const auto& frames = rover_.dataset.frames;
  std::erase_if(inertial, [&](const InertialSample& sample) {
    return sample.stamp_ns > frames[2].stamp_ns && sample.stamp_ns < frames[3].stamp_ns;
  });
  auto wheels = rover_.dataset.wheels;
  std::erase_if(wheels.samples, [&](const WheelSample& sample) {
    return sample.stamp_ns > frames[4].stamp_ns && sample.stamp_ns < frames[5].stamp_ns;
  });
  const WheelWay way(wheels, rover_.dataset.rig, WithoutSlip());
  EXPECT_TRUE(way.Between(frames[3].stamp_ns, frames[4].stamp_ns));
  EXPECT_FALSE(way.Between(frames[4].stamp_ns, frames[4].stamp_ns + kSecondNs / 2));
  bool gap = false;
  for (const SensorStep& step :
       CutSteps(frames[2].stamp_ns, frames[3].stamp_ns, inertial, way, WithoutSlip())) {
    gap = gap || !step.turn_rate_radps;
    EXPECT_TRUE(step.way_m);
  }
  EXPECT_TRUE(gap);
}

TEST_F(SensorStepsTest, StandsStillUntilAWheelTurns) {
  const StampNs first_ns = rover_.dataset.frames.front().stamp_ns;
  EXPECT_TRUE(way_.StandsStill(first_ns - 3 * kSecondNs, first_ns - kSecondNs));
  EXPECT_FALSE(way_.StandsStill(first_ns - 3 * kSecondNs, first_ns + kSecondNs));
  EXPECT_FALSE(way_.StandsStill(first_ns - 100 * kSecondNs, first_ns)) << "nothing is known";
  auto wheels = rover_.dataset.wheels;
  std::erase_if(wheels.samples, [&](const WheelSample& sample) {
    return sample.stamp_ns > first_ns - 2.8 * kSecondNs &&
           sample.stamp_ns < first_ns - 1.2 * kSecondNs;
  });
  const WheelWay torn(wheels, rover_.dataset.rig, WithoutSlip());
  EXPECT_FALSE(torn.StandsStill(first_ns - 3 * kSecondNs, first_ns - kSecondNs)) << "a gap";
}

TEST(FindGap, TellsTheFirstThatIsTooLong) {
  const std::vector<StampNs> stamps{0, kSecondNs, 3 * kSecondNs, 9 * kSecondNs};
  EXPECT_FALSE(FindGap(stamps, 0, kSecondNs, 1.5));
  const auto gap = FindGap(stamps, 0, 9 * kSecondNs, 1.5);
  ASSERT_TRUE(gap);
  EXPECT_EQ(gap->begin_ns, kSecondNs);
  EXPECT_NEAR(gap->duration_s, 2.0, 1e-9);
  EXPECT_TRUE(FindGap(stamps, 8 * kSecondNs, 20 * kSecondNs, 1.5)) << "none at the end";
  EXPECT_TRUE(FindGap({}, 0, 2 * kSecondNs, 1.5));
}

}  // namespace
}  // namespace rigmap
