#include "export/tum.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include "core/error.h"
#include "core/file.h"
#include "export/pose_text.h"

namespace rigmap {
namespace {

constexpr const char* kLayout = "t tx ty tz qx qy qz qw";
constexpr std::size_t kFieldCount = 8;

std::vector<std::string_view> SplitFields(std::string_view line) {
  constexpr std::string_view kSeparators = " \t,\r";
  std::vector<std::string_view> fields;
  for (auto begin = line.find_first_not_of(kSeparators); begin != std::string_view::npos;) {
    const auto end = std::min(line.find_first_of(kSeparators, begin), line.size());
    fields.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(kSeparators, end);
  }
  return fields;
}

double ParseNumber(std::string_view text) {
  std::string_view digits = text;
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
  double value = 0.0;
  const char* end = digits.data() + digits.size();
  const auto result = std::from_chars(digits.data(), end, value);
  if (result.ec != std::errc() || result.ptr != end || !std::isfinite(value)) {
    throw DataError(fmt::format("expected a finite number, found '{}'", text));
  }
  return value;
}

TumPose ParsePose(const std::vector<std::string_view>& fields) {
  if (fields.size() != kFieldCount) {
    throw DataError(
        fmt::format("expected {} fields '{}', found {}", kFieldCount, kLayout, fields.size()));
  }
  Eigen::Matrix<double, 7, 1> v;
  for (int i = 0; i < 7; ++i) v(i) = ParseNumber(fields[i + 1]);
  const double length = v.tail<4>().norm();
  constexpr double kMaxLengthError = 1e-2;  // above what a few printed decimals can do
  if (!(std::abs(length - 1.0) <= kMaxLengthError)) {
    throw DataError(fmt::format("expected a unit quaternion, found one of length {:.6g}", length));
  }
  return {ParseSeconds(fields[0]),
          {Eigen::Quaterniond(v(6), v(3), v(4), v(5)).normalized(), v.head<3>()}};
}

}  // namespace

std::string WriteTum(const Trajectory& trajectory, const Rigid3& left_from_body) {
  std::string text;
  for (const TimedPose& pose : trajectory) {
    text += FormatSeconds(pose.stamp_ns) + ' ' +
            FormatPose(pose.world_from_left * left_from_body, ' ') + '\n';
  }
  return text;
}

std::vector<TumPose> ReadTum(const std::filesystem::path& path) {
  const std::string text = ReadTextFile(path);
  std::vector<TumPose> poses;
  int line_number = 0;
  for (std::string_view rest = text; !rest.empty();) {
    const auto end = std::min(rest.find('\n'), rest.size());
    const std::vector<std::string_view> fields = SplitFields(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
    ++line_number;
    if (fields.empty() || fields[0].front() == '#') continue;
    try {
      poses.push_back(ParsePose(fields));
    } catch (const DataError& error) {
      throw DataError(fmt::format("{}:{}: {}", path.string(), line_number, error.what()));
    }
  }
  if (poses.empty()) {
    throw DataError(fmt::format("{}: expected a TUM trajectory (lines '{}'), found no pose",
                                path.string(), kLayout));
  }
  std::stable_sort(poses.begin(), poses.end(),
                   [](const TumPose& a, const TumPose& b) { return a.stamp_ns < b.stamp_ns; });
  return poses;
}

}  // namespace rigmap
