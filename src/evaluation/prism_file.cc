// A prism's track as a text file.
#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <sstream>
#include <string_view>

#include "core/error.h"
#include "core/file.h"
#include "evaluation/prism_metrics.h"

namespace rigmap {
namespace {

constexpr const char* kPrismFileName = "groundtruth_xy.txt";
constexpr std::size_t kPrismFields = 3;

// Empty for a blank line and a comment.
std::vector<std::string> FieldsOf(const std::string& line) {
  std::istringstream stream(line.substr(0, line.find('#')));
  std::vector<std::string> fields;
  for (std::string field; stream >> field;) fields.push_back(field);
  return fields;
}

double ParseMetres(const std::string& field) {
  double value = 0.0;
  const char* end = field.data() + field.size();
  const auto result = std::from_chars(field.data(), end, value);
  if (result.ec != std::errc() || result.ptr != end || !std::isfinite(value)) {
    throw DataError(fmt::format("expected a finite number, found '{}'", field));
  }
  return value;
}

PrismPosition ParsePosition(const std::vector<std::string>& fields) {
  if (fields.size() != kPrismFields) {
    throw DataError(fmt::format("expected 3 fields 't x y', found {}", fields.size()));
  }
  return {ParseSeconds(fields[0]), {ParseMetres(fields[1]), ParseMetres(fields[2])}};
}

}  // namespace

bool IsPrismFile(const std::filesystem::path& path) {
  if (path.filename() == kPrismFileName) return true;
  if (std::filesystem::is_directory(path)) return false;
  std::istringstream stream(ReadTextFile(path));
  for (std::string line; std::getline(stream, line);) {
    const auto fields = FieldsOf(line);
    if (!fields.empty()) return fields.size() == kPrismFields;
  }
  return false;
}

std::vector<PrismPosition> ReadPrismFile(const std::filesystem::path& path) {
  std::vector<PrismPosition> track;
  std::istringstream stream(ReadTextFile(path));
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    const auto fields = FieldsOf(line);
    if (fields.empty()) continue;
    try {
      const PrismPosition position = ParsePosition(fields);
      if (!track.empty() && position.stamp_ns <= track.back().stamp_ns) {
        throw DataError(fmt::format("expected times that increase, found {} after {}", fields[0],
                                    FormatSeconds(track.back().stamp_ns)));
      }
      track.push_back(position);
    } catch (const DataError& error) {
      throw DataError(fmt::format("{}:{}: {}", path.string(), number, error.what()));
    }
  }
  if (track.size() < 2) {
    throw DataError(fmt::format("{}: expected positions of a prism (lines 't x y'), found {}",
                                path.string(), track.size()));
  }
  return track;
}

}  // namespace rigmap
