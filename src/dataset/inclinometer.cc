#include "dataset/inclinometer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <optional>
#include <string_view>

#include "dataset/internal/text_row.h"

namespace rigmap {
namespace {

// Half a second on either side: some 125 rows, enough to average the motor's shaking (0.1 m/s^2 a
// row) down to a milliradian, short enough for the slope to stay the same at 0.5 m/s.
constexpr StampNs kHalfWindowNs = 500'000'000;
constexpr std::size_t kNumbersPerRow = 9;

std::optional<InclinometerSample> ParseSample(std::string_view line) {
  const auto stamp_ns = ParseStamp(NextWord(line));
  if (!stamp_ns) return std::nullopt;
  InclinometerSample sample;
  sample.stamp_ns = *stamp_ns;
  std::array<double, kNumbersPerRow> numbers{};
  for (double& number : numbers) {
    const auto value = ParseFinite(NextWord(line));
    if (!value) return std::nullopt;
    number = *value;
  }
  if (!NextWord(line).empty()) return std::nullopt;
  sample.acceleration_in_imu = {numbers[6], numbers[7], numbers[8]};
  return sample;
}

struct Sum {
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();
  int rows = 0;
};

void AddToFrames(const InclinometerSample& row, std::span<const StereoFrame> frames,
                 std::vector<Sum>& sums) {
  const auto first = std::lower_bound(
      frames.begin(), frames.end(), row.stamp_ns - kHalfWindowNs,
      [](const StereoFrame& frame, StampNs stamp_ns) { return frame.stamp_ns < stamp_ns; });
  for (auto frame = first; frame != frames.end() && frame->stamp_ns <= row.stamp_ns + kHalfWindowNs;
       ++frame) {
    Sum& sum = sums[static_cast<std::size_t>(frame - frames.begin())];
    sum.acceleration += row.acceleration_in_imu;
    ++sum.rows;
  }
}

}  // namespace

InclinometerReading ReadInclinometer(const std::filesystem::path& imu_path,
                                     std::span<const StereoFrame> frames) {
  InclinometerReading reading;
  std::ifstream stream(imu_path);
  if (!stream) return reading;
  std::vector<Sum> sums(frames.size());
  std::string line;
  int line_number = 0, malformed = 0, first_malformed = 0;
  while (std::getline(stream, line)) {
    ++line_number;
    std::string_view words = line;
    if (NextWord(words).empty()) continue;
    if (const auto row = ParseSample(line)) {
      AddToFrames(*row, frames, sums);
    } else if (malformed++ == 0) {
      first_malformed = line_number;
    }
  }
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (sums[i].rows == 0) continue;
    reading.samples.push_back({frames[i].stamp_ns, sums[i].acceleration / sums[i].rows});
  }
  if (malformed > 0) {
    reading.remarks.push_back(fmt::format("{}: {} malformed rows left out, the first in line {}",
                                          imu_path.string(), malformed, first_malformed));
  }
  if (reading.samples.size() < frames.size()) {
    reading.remarks.push_back(fmt::format("{}: no rows within 0.5 s of {} of {} frames",
                                          imu_path.string(), frames.size() - reading.samples.size(),
                                          frames.size()));
  }
  return reading;
}

}  // namespace rigmap
