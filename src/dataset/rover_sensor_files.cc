#include "dataset/rover_sensor_files.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <optional>
#include <string_view>

#include "core/statistics.h"
#include "dataset/internal/text_row.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

constexpr StampNs kBeforeNs = 30'000'000'000, kAfterNs = 2'000'000'000;
// Rows of a busy logger come late by less; a clock that was set goes back by more.
constexpr StampNs kMaxDisorderNs = 100'000'000;
// A step as long as this many usual ones, and at least so long, is no row that came late.
constexpr double kUsualSteps = 20.0, kShortestGap_s = 0.5;
constexpr std::size_t kGapsNamed = 5;
// Gravity is 9.78 to 9.83 m/s^2; a mean over a drive differs from it by the sensor's own scale and
// bias. An inclinometer whose z axis is more than 45 degrees off up does not sit as z up.
constexpr double kLeastGravity_mps2 = 9.0, kMostGravity_mps2 = 10.6, kLeastUpright = 0.7;
// No rover turns as fast; 9.8 in a column of rates is an acceleration.
constexpr double kFastestTurn_radps = 3.0;

template <std::size_t kCount>
std::optional<std::array<double, kCount>> ParseNumbers(std::string_view line) {
  std::array<double, kCount> numbers{};
  for (double& number : numbers) {
    const auto value = ParseFinite(NextWord(line));
    if (!value) return std::nullopt;
    number = *value;
  }
  return NextWord(line).empty() ? std::optional(numbers) : std::nullopt;
}

std::optional<WheelSample> ParseWheels(StampNs stamp_ns, std::string_view rest) {
  constexpr std::size_t kJointFields = 3;
  const auto numbers = ParseNumbers<33>(rest);
  if (!numbers) return std::nullopt;
  WheelSample sample{.stamp_ns = stamp_ns};
  const std::size_t drives = sample.drive_angle_rad.size();
  for (std::size_t i = 0; i < drives; ++i) {
    sample.drive_angle_rad[i] = (*numbers)[kJointFields * i];
    sample.drive_rate_radps[i] = (*numbers)[kJointFields * i + 1];
  }
  for (std::size_t i = 0; i < sample.steering_rad.size(); ++i) {
    sample.steering_rad[i] = (*numbers)[kJointFields * (drives + i)];
  }
  return sample;
}

std::optional<InertialSample> ParseInertial(StampNs stamp_ns, std::string_view rest) {
  const auto numbers = ParseNumbers<9>(rest);
  if (!numbers) return std::nullopt;
  const double* const n = numbers->data();
  return InertialSample{stamp_ns, Eigen::Vector3d(n[3], n[4], n[5]),
                        Eigen::Vector3d(n[6], n[7], n[8])};
}

double Seconds(StampNs duration_ns) { return 1e-9 * static_cast<double>(duration_ns); }

// Between the row of this line and the one before it.
struct LongStep {
  int line = 0;
  StampNs from_ns = 0, to_ns = 0;
};

template <class Record>
struct RecordReading {
  Record record;
  std::vector<std::string> remarks;  // on rows that were left out
  std::vector<LongStep> long_steps;  // of kShortestGap_s or more, wherever in the file
};

// All rows that `parse` takes, within the span.
template <class Record, class Parse>
RecordReading<Record> ReadRecord(const fs::path& path, StampNs begin_ns, StampNs end_ns,
                                 std::string_view expected, Parse parse) {
  RecordReading<Record> reading;
  auto& [samples, problem] = reading.record;
  std::ifstream stream(path);
  if (!stream) {
    problem = fmt::format("{}: expected rows of {}, found no such file", path.string(), expected);
    return reading;
  }
  std::string text;
  StampNs last_ns = 0;
  int line = 0, left_out = 0, first_left_out = 0, used = 0;
  while (std::getline(stream, text)) {
    ++line;
    std::string_view rest = text;
    const auto word = NextWord(rest);
    if (word.empty()) continue;
    const auto stamp_ns = ParseStamp(word);
    const auto sample = stamp_ns ? parse(*stamp_ns, rest) : std::nullopt;
    if (sample && *stamp_ns < last_ns - kMaxDisorderNs) {
      problem = fmt::format("{}:{}: expected rising stamps, found one {:.3f} s before that above",
                            path.string(), line, Seconds(last_ns - *stamp_ns));
      return reading;
    }
    if (!sample || *stamp_ns <= last_ns) {
      if (left_out++ == 0) first_left_out = line;
      continue;
    }
    if (used > 0 && Seconds(*stamp_ns - last_ns) >= kShortestGap_s) {
      reading.long_steps.push_back({line, last_ns, *stamp_ns});
    }
    last_ns = *stamp_ns;
    ++used;
    if (*stamp_ns >= begin_ns && *stamp_ns <= end_ns) samples.push_back(*sample);
  }
  if (left_out > 0) {
    reading.remarks.push_back(
        fmt::format("{}: {} rows that are malformed or repeat a stamp left out, the first in line "
                    "{}",
                    path.string(), left_out, first_left_out));
  }
  if (used == 0) {
    problem = fmt::format("{}: expected rows of {}, found none", path.string(), expected);
  } else if (samples.empty()) {
    problem = fmt::format("{}: expected rows at the time of the images, found none", path.string());
  }
  return reading;
}

// Of a clock that was set forwards, or of a logger that stood still, while images were taken.
template <class Record>
std::vector<std::string> GapRemarks(const fs::path& path, const RecordReading<Record>& reading,
                                    std::span<const StereoFrame> frames) {
  const auto& samples = reading.record.samples;
  std::vector<double> steps_s;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    steps_s.push_back(Seconds(samples[i].stamp_ns - samples[i - 1].stamp_ns));
  }
  if (steps_s.empty()) return {};
  const double usual_s = Median(std::move(steps_s));
  const StampNs begin_ns = frames.front().stamp_ns, end_ns = frames.back().stamp_ns;
  std::vector<std::string> remarks;
  std::size_t gaps = 0;
  for (const LongStep& step : reading.long_steps) {
    const double step_s = Seconds(step.to_ns - step.from_ns);
    if (step.to_ns <= begin_ns || step.from_ns >= end_ns || step_s < kUsualSteps * usual_s) {
      continue;
    }
    if (++gaps > kGapsNamed) continue;
    remarks.push_back(fmt::format(
        "{}:{}: expected rows about every {:.3g} s, found none for {:.3f} s from {:.2f} s after "
        "the first image: either rows are missing or the clock jumped forwards",
        path.string(), step.line, usual_s, step_s, Seconds(step.from_ns - begin_ns)));
  }
  if (gaps > kGapsNamed) {
    remarks.push_back(fmt::format("{}: and {} more such gaps", path.string(), gaps - kGapsNamed));
  }
  return remarks;
}

// Between two samples by rates, and by angles, of which full turns are taken off.
struct Turned {
  double by_rate_rad = 0.0, by_angle_rad = 0.0;
};
Turned TurnedBetween(const WheelSample& a, const WheelSample& b, std::size_t drive) {
  const double step_s = 1e-9 * static_cast<double>(b.stamp_ns - a.stamp_ns);
  Turned turned{0.5 * step_s * (a.drive_rate_radps[drive] + b.drive_rate_radps[drive]),
                b.drive_angle_rad[drive] - a.drive_angle_rad[drive]};
  const double off_rad = turned.by_angle_rad - turned.by_rate_rad;
  turned.by_angle_rad = turned.by_rate_rad + std::remainder(off_rad, 2.0 * std::numbers::pi);
  return turned;
}

// Joints that go round, or drives that turn as no rover's do.
std::string JointProblem(const fs::path& path, const std::vector<WheelSample>& samples) {
  // Of a joint, from one side to the other; with wheels of 12 cm 30 rad/s are 13 km/h.
  constexpr double kMostSteered_rad = std::numbers::pi, kFastestDrive_radps = 30.0;
  constexpr double kFew = 0.01;  // rows that may be spoilt
  const auto by_stamp = [&](const auto& value) {
    std::vector<double> values;
    for (const WheelSample& sample : samples) values.push_back(value(sample));
    return values;
  };
  for (std::size_t joint = 0; joint < 4; ++joint) {
    const auto angles =
        by_stamp([&](const WheelSample& sample) { return sample.steering_rad[joint]; });
    const double least = Quantile(angles, kFew), most = Quantile(angles, 1.0 - kFew);
    if (most - least <= kMostSteered_rad) continue;
    return fmt::format(
        "{}: expected steering joint {} (field {}) to stay within half a turn, found {:.1f} rad "
        "from one side to the other: are columns exchanged, or angles in degrees?",
        path.string(), joint + 1, 3 * (6 + joint) + 2, most - least);
  }
  for (std::size_t drive = 0; drive < 6; ++drive) {
    const double rate_radps = Quantile(by_stamp([&](const WheelSample& sample) {
                                         return std::abs(sample.drive_rate_radps[drive]);
                                       }),
                                       0.9);
    if (rate_radps <= kFastestDrive_radps) continue;
    return fmt::format(
        "{}: expected rates of drive {} (field {}) below {} rad/s, found {:.0f} and more in a "
        "tenth of the rows: are they in degrees?",
        path.string(), drive + 1, 3 * drive + 3, kFastestDrive_radps, rate_radps);
  }
  return {};
}

std::string WheelProblem(const fs::path& path, const std::vector<WheelSample>& samples) {
  // Rates are noisy and sampled: what is turned by them may be off by a fifth, and a little.
  constexpr double kMaxShare = 0.2, kMaxOff_rad = 0.5;
  for (std::size_t drive = 0; drive < 6; ++drive) {
    double turned_rad = 0.0, off_rad = 0.0;
    for (std::size_t i = 1; i < samples.size(); ++i) {
      const Turned step = TurnedBetween(samples[i - 1], samples[i], drive);
      turned_rad += std::abs(step.by_rate_rad);
      off_rad += std::abs(step.by_angle_rad - step.by_rate_rad);
    }
    if (off_rad > kMaxShare * turned_rad + kMaxOff_rad) {
      return fmt::format(
          "{}: expected the angle of drive {} (field {}) to change as its rate (field {}) says, "
          "found {:.1f} rad of difference over {:.1f} rad: are columns exchanged?",
          path.string(), drive + 1, 3 * drive + 2, 3 * drive + 3, off_rad, turned_rad);
    }
  }
  return JointProblem(path, samples);
}

std::string InertialProblem(const fs::path& path, const std::vector<InertialSample>& samples) {
  Eigen::Vector3d up = Eigen::Vector3d::Zero();
  std::vector<double> turns_radps;
  for (const InertialSample& sample : samples) {
    up += sample.inclination_mps2 / static_cast<double>(samples.size());
    turns_radps.push_back(sample.angular_rate_radps.norm());
  }
  // Most of a slow drive it hardly turns, in whatever unit.
  const double size_mps2 = up.norm(), turn_radps = Quantile(std::move(turns_radps), 0.99);
  if (size_mps2 < kLeastGravity_mps2 || size_mps2 > kMostGravity_mps2 ||
      up.z() < kLeastUpright * size_mps2) {
    return fmt::format(
        "{}: expected gravity, about 9.8 m/s^2 along z, in the inclinometer's fields 8 to 10, "
        "found ({:.2f}, {:.2f}, {:.2f}) in the mean: are columns exchanged?",
        path.string(), up.x(), up.y(), up.z());
  }
  if (turn_radps > kFastestTurn_radps) {
    return fmt::format(
        "{}: expected angular rates below {} rad/s in fields 5 to 7, found {:.2f} and more in a "
        "hundredth of the rows: are columns exchanged, or rates in degrees?",
        path.string(), kFastestTurn_radps, turn_radps);
  }
  return {};
}

}  // namespace

void UnwrapDriveAngles(std::vector<WheelSample>& samples) {
  if (samples.empty()) return;
  for (std::size_t drive = 0; drive < samples.front().drive_angle_rad.size(); ++drive) {
    double angle_rad = samples.front().drive_angle_rad[drive];
    WheelSample before = samples.front();
    for (std::size_t i = 1; i < samples.size(); ++i) {
      angle_rad += TurnedBetween(before, samples[i], drive).by_angle_rad;
      before = samples[i];
      samples[i].drive_angle_rad[drive] = angle_rad;
    }
  }
}

RoverSensorReading ReadRoverSensors(const fs::path& part_folder,
                                    std::span<const StereoFrame> frames) {
  const StampNs begin_ns = frames.front().stamp_ns - kBeforeNs;
  const StampNs end_ns = frames.back().stamp_ns + kAfterNs;
  const fs::path wheel_path = part_folder / "odometry.txt", imu_path = part_folder / "imu.txt";
  auto wheels = ReadRecord<WheelRecord>(
      wheel_path, begin_ns, end_ns, "a stamp and 33 numbers of the rover's joints", ParseWheels);
  auto inertial = ReadRecord<InertialRecord>(
      imu_path, begin_ns, end_ns, "a stamp and 9 numbers of the inertial unit", ParseInertial);
  if (wheels.record.problem.empty()) {
    wheels.record.problem = WheelProblem(wheel_path, wheels.record.samples);
    UnwrapDriveAngles(wheels.record.samples);
  }
  RoverSensorReading reading;
  // Also of the rows before a clock went back.
  if (!inertial.record.samples.empty()) {
    reading.inclinometer_problem = InertialProblem(imu_path, inertial.record.samples);
  }
  if (inertial.record.problem.empty()) inertial.record.problem = reading.inclinometer_problem;
  // What imu.txt has malformed its other reader tells.
  reading.remarks = std::move(wheels.remarks);
  for (const auto& gaps :
       {GapRemarks(wheel_path, wheels, frames), GapRemarks(imu_path, inertial, frames)}) {
    reading.remarks.insert(reading.remarks.end(), gaps.begin(), gaps.end());
  }
  reading.wheels = std::move(wheels.record);
  reading.inertial = std::move(inertial.record);
  return reading;
}

}  // namespace rigmap
