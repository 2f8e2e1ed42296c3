#include "simulation/internal/imu.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "dataset/inclinometer.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

const SensorClock kImuClock{ParseKatwijkStamp("2015_11_26_15_23_38_849"), 7};
const RoverMount kMount = MountOf(StereoRig{});

RoverPath PathOf(const std::string& shape) { return MakeRoverPath({shape, 40, 0.2, 1.25, 0.5}); }
double FlatGround(double, double) { return 0.0; }
double Rough(double east_m, double north_m) {
  return 0.08 * std::sin(0.9 * east_m) * std::cos(0.7 * north_m);
}

bool IsAtRest(const ImuSample& sample) { return kImuClock.TimeAt(sample.stamp_ns) < -0.2; }

TEST(Imu, MeasuresGravityAtRest) {
  const RoverMotion motion(PathOf("straight"), [](double east_m, double north_m) {
    return 0.1 * east_m - 0.2 * north_m;
  });
  const Eigen::Vector3d up_in_imu =
      (motion.WorldFromBody(0.0) * kMount.body_from_imu).rotation.conjugate() *
      Eigen::Vector3d::UnitZ();
  int at_rest = 0;
  for (const ImuSample& sample : SimulateImu(motion, kMount, kImuClock, ImuNoise::None())) {
    if (!IsAtRest(sample)) continue;
    ++at_rest;
    EXPECT_LT((sample.specific_force_mps2 - kGravity_mps2 * up_in_imu).norm(), 1e-6);
    EXPECT_LT((sample.inclinometer_mps2 - kGravity_mps2 * up_in_imu).norm(), 1e-6);
    EXPECT_LT(sample.angular_rate_radps.norm(), 1e-9);
  }
  EXPECT_GT(at_rest, 400);
}

// x looks backward and y to the right: nose up reads negative in x, left side up in y.
TEST(Imu, AxesLookBackwardAndRight) {
  const auto first_force = [](const GroundHeight& ground) {
    const RoverMotion motion(MakeRoverPath({"straight", 10, 0.2, 1.25, 0.0}), ground);
    return SimulateImu(motion, kMount, kImuClock, ImuNoise::None()).front().specific_force_mps2;
  };
  EXPECT_LT(first_force([](double east_m, double) { return 0.1 * east_m; }).x(), -0.9);
  EXPECT_LT(first_force([](double, double north_m) { return 0.1 * north_m; }).y(), -0.9);
}

TEST(Imu, IntegratedTurningRateIsTheHeadingsChange) {
  for (const char* shape : {"loop", "spot-turn", "s-curve", "backwards"}) {
    const RoverMotion motion(PathOf(shape), FlatGround);
    const double turned_rad = motion.path().At(1e3).heading_rad - motion.path().At(0.0).heading_rad;
    double exact_rad = 0.0, noisy_rad = 0.0;
    for (const ImuSample& sample : SimulateImu(motion, kMount, kImuClock, ImuNoise::None())) {
      exact_rad += 0.008 * sample.angular_rate_radps.z();
    }
    for (const ImuSample& sample : SimulateImu(motion, kMount, kImuClock)) {
      noisy_rad += 0.008 * sample.angular_rate_radps.z();
    }
    EXPECT_NEAR(exact_rad, turned_rad, 1e-4) << shape;
    EXPECT_NEAR(noisy_rad, turned_rad, 0.03) << shape;  // four sigmas of bias over 56 s
    EXPECT_NE(noisy_rad, exact_rad);
  }
}

TEST(Imu, IntegratedForceIsTheSpeed) {
  const RoverMotion motion(MakeRoverPath({"straight", 40, 0.5, 1.0, 0.0}), FlatGround);
  double speed_mps = 0.0;
  for (const ImuSample& sample : SimulateImu(motion, kMount, kImuClock, ImuNoise::None())) {
    speed_mps -= 0.008 * sample.specific_force_mps2.x();
    const double time_s = kImuClock.TimeAt(sample.stamp_ns);
    if (time_s > 1.0 && time_s < 39.0) {
      EXPECT_NEAR(speed_mps, 0.5, 5e-3);
    }
  }
  EXPECT_NEAR(speed_mps, 0.0, 5e-3);
}

TEST(Imu, NoiseIsThatOfTheRealExcerpt) {
  const RoverMotion motion(PathOf("straight"), FlatGround);
  Eigen::Vector3d force = Eigen::Vector3d::Zero(), rate = force, level = force, steps = force;
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  double count = 0.0;
  for (const ImuSample& sample : SimulateImu(motion, kMount, kImuClock)) {
    if (!IsAtRest(sample)) continue;
    const Eigen::Vector3d up = kGravity_mps2 * Eigen::Vector3d::UnitZ();
    force += (sample.specific_force_mps2 - up).cwiseAbs2();
    rate += sample.angular_rate_radps.cwiseAbs2();
    level += (sample.inclinometer_mps2 - up).cwiseAbs2();
    if (count > 0.0) steps += (sample.inclinometer_mps2 - last).cwiseAbs2();
    last = sample.inclinometer_mps2;
    count += 1.0;
  }
  EXPECT_NEAR(std::sqrt(force.x() / count), 0.28, 0.03);    // m/s^2
  EXPECT_NEAR(std::sqrt(rate.x() / count), 0.005, 0.0005);  // rad/s
  EXPECT_NEAR(std::sqrt(level.x() / count), 0.03, 0.01);    // m/s^2
  EXPECT_LT(steps.x(), level.x());
}

TEST(Imu, RowsReadBackAndSomeSecondsAreWrittenAsThousandMilliseconds) {
  const RoverMotion motion(PathOf("u-turn"), Rough);
  const auto samples = SimulateImu(motion, kMount, kImuClock);
  std::stringstream stream;
  WriteImuRows(stream, samples);
  std::size_t count = 0, thousands = 0;
  for (std::string line; std::getline(stream, line); ++count) {
    std::istringstream words(line);
    std::string stamp;
    words >> stamp;
    thousands += stamp.ends_with("_1000") ? 1 : 0;
    EXPECT_EQ(ParseKatwijkStamp(stamp), samples.at(count).stamp_ns);
    Eigen::Matrix<double, 9, 1> numbers;
    for (double& number : numbers) ASSERT_TRUE(words >> number) << line;
    EXPECT_LT((numbers.head<3>() - samples[count].specific_force_mps2).norm(), 1e-12);
    EXPECT_LT((numbers.tail<3>() - samples[count].inclinometer_mps2).norm(), 1e-12);
    EXPECT_TRUE((words >> std::ws).eof()) << line;
  }
  EXPECT_EQ(count, samples.size());
  EXPECT_GT(thousands, 0U);
  for (std::size_t i = 1; i < samples.size(); ++i) {
    EXPECT_GT(samples[i].stamp_ns, samples[i - 1].stamp_ns);
  }
}

TEST(Imu, DatasetReadsTheSlopeFromIt) {
  const RoverMotion motion(PathOf("s-curve"), Rough);
  const TemporaryFolder folder;
  {
    std::ofstream file(folder.Path() / "imu.txt");
    WriteImuRows(file, SimulateImu(motion, kMount, kImuClock));
  }
  std::vector<StereoFrame> frames;
  // Not the first and the last: there it feels the start and the stop.
  for (int i = 1; i < 40; ++i) frames.push_back({kImuClock.StampAt(1.25 * i), "", ""});
  const InclinometerReading reading = ReadInclinometer(folder.Path() / "imu.txt", frames);
  EXPECT_TRUE(reading.remarks.empty());
  ASSERT_EQ(reading.samples.size(), frames.size());
  for (const InclinometerSample& sample : reading.samples) {
    const Rigid3 world_from_imu =
        motion.WorldFromBody(kImuClock.TimeAt(sample.stamp_ns)) * kMount.body_from_imu;
    const Eigen::Vector3d up = world_from_imu.rotation.conjugate() * Eigen::Vector3d::UnitZ();
    EXPECT_LT((sample.acceleration_in_imu.normalized() - up).norm(), 0.01);  // rad
  }
}

}  // namespace
}  // namespace rigmap
