#include "simulation/internal/wheel_odometry.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/stamp.h"

namespace rigmap {
namespace {

const SensorClock kClock{ParseKatwijkStamp("2015_11_26_15_23_38_849"), 7};

double Flat(double, double) { return 0.0; }

std::vector<OdometrySample> Drive(const std::string& shape, const GroundHeight& ground = Flat,
                                  const std::vector<TimeSpan>& bursts = {}) {
  const RoverMotion motion(MakeRoverPath({shape, 60, 0.2, 1.25, 0.0}), ground);
  return SimulateWheelOdometry(motion, kClock, bursts);
}

// Mean over the wheels of a side, in metres of ground without slip.
double WayOf(const OdometrySample& sample, std::size_t first_wheel) {
  double sum_rad = 0.0;
  for (std::size_t i = first_wheel; i < 6; i += 2) sum_rad += sample.drives[i].angle_rad;
  return sum_rad / 3.0 * kWheelRadius_m;
}

double MeanWay(const OdometrySample& sample) { return 0.5 * (WayOf(sample, 0) + WayOf(sample, 1)); }

const OdometrySample& SampleAt(const std::vector<OdometrySample>& samples, double time_s) {
  return *std::ranges::lower_bound(samples, kClock.StampAt(time_s), {}, &OdometrySample::stamp_ns);
}

TEST(WheelOdometry, IntegratesToTheWayWithinSlip) {
  for (const char* shape : {"straight", "stop-and-go", "traverse3", "backwards"}) {
    const RoverPath path = MakeRoverPath({shape, 60, 0.2, 1.25, 0.0});
    const double sign = std::string(shape) == "backwards" ? -1.0 : 1.0;
    const double ratio = sign * MeanWay(Drive(shape).back()) / path.length_m();
    EXPECT_GT(ratio, 1.0) << shape;
    EXPECT_LT(ratio, 1.06) << shape;
  }
}

TEST(WheelOdometry, StandsStillAtRest) {
  const auto samples = Drive("straight");
  EXPECT_LT(samples.front().stamp_ns, kClock.StampAt(-3.0));
  for (const JointReading& drive : SampleAt(samples, -0.2).drives) {
    EXPECT_EQ(drive.angle_rad, 0.0);
    EXPECT_EQ(drive.rate_radps, 0.0);
  }
}

TEST(WheelOdometry, RatesAreTheAnglesChange) {
  const auto samples = Drive("s-curve");
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const double step_s = 1e-9 * static_cast<double>(samples[i].stamp_ns - samples[i - 1].stamp_ns);
    EXPECT_NEAR(step_s, 0.08, 0.014);
    for (std::size_t wheel = 0; wheel < 6; ++wheel) {
      const double change =
          samples[i].drives[wheel].angle_rad - samples[i - 1].drives[wheel].angle_rad;
      EXPECT_NEAR(change / step_s, samples[i].drives[wheel].rate_radps, 0.35);  // rad/s, at starts
    }
  }
}

TEST(WheelOdometry, OuterWheelsGoFartherAndCornersPointAcrossTheCentre) {
  const RoverPath path = MakeRoverPath({"loop", 60, 0.2, 1.25, 0.0});
  const auto samples = Drive("loop");
  // Left turn of 1.25 rounds: the right side goes farther by the turn times the track, but for slip
  // and the corners' wider circles.
  const double more_m = WayOf(samples.back(), 1) - WayOf(samples.back(), 0);
  EXPECT_NEAR(more_m, 2.0 * kHalfTrack_m * path.At(1e3).heading_rad, 0.8);
  const auto& steering = SampleAt(samples, 30.0).steering;
  const PlanarState state = path.At(30.0);
  const double radius_m = state.speed_mps / state.yaw_rate_radps;
  EXPECT_NEAR(std::tan(steering[0].angle_rad), kWheelBase_m / (radius_m - kHalfTrack_m), 1e-3);
  EXPECT_NEAR(std::tan(steering[1].angle_rad), kWheelBase_m / (radius_m + kHalfTrack_m), 1e-3);
  EXPECT_NEAR(steering[2].angle_rad, -steering[0].angle_rad, 1e-9);
  EXPECT_NEAR(steering[3].angle_rad, -steering[1].angle_rad, 1e-9);
}

TEST(WheelOdometry, TurnsOnTheSpotWithOppositeSides) {
  const auto samples = Drive("spot-turn");
  const OdometrySample& turning = SampleAt(samples, 37.5);
  EXPECT_NEAR(turning.steering[0].angle_rad, -kLargestSteering_rad, 1e-9);
  EXPECT_NEAR(turning.steering[1].angle_rad, kLargestSteering_rad, 1e-9);
  for (std::size_t wheel = 0; wheel < 6; ++wheel) {
    EXPECT_EQ(turning.drives[wheel].rate_radps > 0.0, wheel % 2 == 1) << wheel;
  }
}

TEST(WheelOdometry, BurstsMakeTheWheelsTurnFaster) {
  const TimeSpan burst{20.0, 23.0};
  const auto calm = Drive("straight"), slipping = Drive("straight", Flat, {burst});
  const auto ratio_over = [&](double from_s, double to_s) {
    return (MeanWay(SampleAt(slipping, to_s)) - MeanWay(SampleAt(slipping, from_s))) /
           (MeanWay(SampleAt(calm, to_s)) - MeanWay(SampleAt(calm, from_s)));
  };
  EXPECT_NEAR(ratio_over(5.0, 19.5), 1.0, 1e-9);
  EXPECT_GT(ratio_over(burst.begin_s, burst.end_s), 1.2);
  EXPECT_GT(ratio_over(21.4, 21.6), 1.35);
  EXPECT_LT(ratio_over(21.4, 21.6), 1.6);
  EXPECT_NEAR(ratio_over(24.0, 40.0), 1.0, 1e-9);
}

TEST(WheelOdometry, BogiesFollowTheGround) {
  constexpr double kTolerance_rad = 0.006;  // six sigmas of the sensors' noise
  // Straight ahead along x: the left side (y > 0) rises where it is meant to.
  const OdometrySample level = Drive("straight").front();
  EXPECT_NEAR(level.rocker_rad, 0.0, kTolerance_rad);
  EXPECT_NEAR(level.left_bogie_rad, 0.0, kTolerance_rad);
  const OdometrySample left_nose_up =
      Drive("straight", [](double x, double y) { return y > 0.0 ? 0.1 * x : 0.0; }).front();
  EXPECT_NEAR(left_nose_up.rocker_rad, 0.05, kTolerance_rad);
  EXPECT_NEAR(left_nose_up.left_bogie_rad, 0.0, kTolerance_rad);
  const OdometrySample left_middle_up = Drive("straight", [](double x, double y) {
                                          return y > 0.0 && std::abs(x) < 0.2 ? 0.03 : 0.0;
                                        }).front();
  EXPECT_NEAR(left_middle_up.left_bogie_rad, 0.03 / kWheelBase_m, kTolerance_rad);
  EXPECT_NEAR(left_middle_up.right_bogie_rad, 0.0, kTolerance_rad);
  EXPECT_NEAR(left_middle_up.rocker_rad, 0.0, kTolerance_rad);
}

TEST(WheelOdometry, RowsHaveThirtyFourFields) {
  const auto samples = Drive("s-curve");
  std::stringstream stream;
  WriteOdometryRows(stream, samples);
  std::size_t count = 0;
  for (std::string line; std::getline(stream, line); ++count) {
    std::istringstream words(line);
    std::string stamp;
    words >> stamp;
    EXPECT_EQ(ParseKatwijkStamp(stamp), samples.at(count).stamp_ns);
    std::vector<double> numbers;
    for (double number = 0.0; words >> number;) numbers.push_back(number);
    ASSERT_EQ(numbers.size(), 33U) << line;
    EXPECT_TRUE(words.eof()) << line;
    EXPECT_NEAR(numbers[0], samples[count].drives[0].angle_rad, 1e-6);
    EXPECT_NEAR(numbers[18], samples[count].steering[0].angle_rad, 1e-6);
    EXPECT_NEAR(numbers[31], samples[count].left_bogie_rad, 1e-12);
  }
  EXPECT_EQ(count, samples.size());
}

}  // namespace
}  // namespace rigmap
