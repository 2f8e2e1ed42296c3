#include "dataset/internal/gnss_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <string_view>

#include "core/error.h"
#include "core/file.h"
#include "dataset/internal/text_row.h"
#include "georeference/utm.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kExpectedRow =
    "stamp, status, latitude and longitude or UTM metres, altitude and three sigmas";

enum class Coordinates { kLatitudeFirst, kEastingFirst, kNorthingFirst };

struct Row {
  int line = 0;
  std::string text;
  std::optional<Coordinates> coordinates;  // nothing: malformed
  GnssFix fix;                             // latitude and longitude not yet set
  double first = 0.0, second = 0.0;
};

std::optional<Coordinates> CoordinatesOf(double first, double second) {
  if (std::abs(first) <= 90.0 && std::abs(second) <= 180.0) return Coordinates::kLatitudeFirst;
  const auto columns = GridColumnsOf(first, second);
  if (!columns) return std::nullopt;
  return *columns == GridColumns::kEastingFirst ? Coordinates::kEastingFirst
                                                : Coordinates::kNorthingFirst;
}

Row ParseFix(const std::string& text, int line) {
  Row row{.line = line, .text = text};
  std::string_view rest = text;
  const auto stamp_ns = ParseStamp(NextWord(rest));
  row.fix.status = NextWord(rest);
  std::array<double, 6> numbers{};
  for (double& number : numbers) {
    const auto value = ParseFinite(NextWord(rest));
    if (!value) return row;
    number = *value;
  }
  const auto [first, second, altitude_m, north_m, east_m, up_m] = numbers;
  if (!stamp_ns || !NextWord(rest).empty() || std::min({north_m, east_m, up_m}) < 0.0) return row;
  row.fix.stamp_ns = *stamp_ns;
  row.fix.altitude_m = altitude_m;
  row.fix.sigma_enu_m = {east_m, north_m, up_m};
  row.first = first;
  row.second = second;
  row.coordinates = CoordinatesOf(first, second);
  return row;
}

std::vector<Row> ParseRows(const std::string& text) {
  std::vector<Row> rows;
  std::istringstream stream(text);
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    std::string_view words = line;
    if (!NextWord(words).empty()) rows.push_back(ParseFix(line, number));
  }
  return rows;
}

std::optional<Coordinates> MostFrequent(const std::vector<Row>& rows) {
  std::array<int, 3> counts{};
  for (const Row& row : rows) {
    if (row.coordinates) ++counts[static_cast<std::size_t>(*row.coordinates)];
  }
  const auto most = std::max_element(counts.begin(), counts.end());
  if (*most == 0) return std::nullopt;
  return static_cast<Coordinates>(most - counts.begin());
}

GnssFix Locate(const Row& row) {
  GnssFix fix = row.fix;
  fix.latitude_deg = row.first;
  fix.longitude_deg = row.second;
  if (*row.coordinates == Coordinates::kLatitudeFirst) return fix;
  const bool easting_first = *row.coordinates == Coordinates::kEastingFirst;
  const Geodetic position = FromUtm31(easting_first ? row.first : row.second,
                                      easting_first ? row.second : row.first, fix.altitude_m);
  fix.latitude_deg = position.latitude_deg;
  fix.longitude_deg = position.longitude_deg;
  return fix;
}

}  // namespace

GnssReading ReadGnssFile(const fs::path& path) {
  const std::vector<Row> rows = ParseRows(ReadTextFile(path));
  const auto coordinates = MostFrequent(rows);
  if (!coordinates) {
    const Row first = rows.empty() ? Row{.line = 1} : rows.front();
    throw DataError(fmt::format("{}:{}: expected rows of {}, found '{}'", path.string(), first.line,
                                kExpectedRow, first.text));
  }
  GnssReading reading;
  std::vector<const Row*> left_out;
  for (const Row& row : rows) {
    if (row.coordinates == coordinates) {
      reading.fixes.push_back(Locate(row));
    } else {
      left_out.push_back(&row);
    }
  }
  std::ranges::stable_sort(reading.fixes, {}, &GnssFix::stamp_ns);
  if (!left_out.empty()) {
    reading.remarks.push_back(Legible(
        fmt::format("{}:{}: expected {}, the same in all rows, found '{}'; {} of {} rows left out",
                    path.string(), left_out.front()->line, kExpectedRow, left_out.front()->text,
                    left_out.size(), rows.size())));
  }
  return reading;
}

std::optional<GnssReading> ReadGnss(const fs::path& part_folder) {
  for (const char* name : {"gps-latlong.txt", "gps-utm31.txt"}) {
    const fs::path path = part_folder / name;
    std::error_code ignored;
    if (fs::is_regular_file(path, ignored)) return ReadGnssFile(path);
  }
  return std::nullopt;
}

}  // namespace rigmap
