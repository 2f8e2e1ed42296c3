#include "dataset/internal/gnss_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <regex>
#include <sstream>
#include <string_view>

#include "core/error.h"
#include "core/file.h"
#include "dataset/internal/text_row.h"

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

// Of gps-utm31.txt and gps-utm19s.txt; nothing for another name.
std::optional<UtmZone> ZoneInName(const std::string& name) {
  static const std::regex kName("gps-utm([0-9]{1,2})([ns]?)\\.txt");
  std::smatch match;
  if (!std::regex_match(name, match, kName)) return std::nullopt;
  const UtmZone zone{std::stoi(match[1]), match[2] != "s"};
  return zone.number >= 1 && zone.number <= 60 ? std::optional(zone) : std::nullopt;
}

GnssFix Locate(const Row& row, const UtmZone& zone) {
  GnssFix fix = row.fix;
  fix.latitude_deg = row.first;
  fix.longitude_deg = row.second;
  if (*row.coordinates == Coordinates::kLatitudeFirst) return fix;
  const bool easting_first = *row.coordinates == Coordinates::kEastingFirst;
  const Geodetic position = FromUtm(zone, easting_first ? row.first : row.second,
                                    easting_first ? row.second : row.first, fix.altitude_m);
  fix.latitude_deg = position.latitude_deg;
  fix.longitude_deg = position.longitude_deg;
  return fix;
}

}  // namespace

GnssReading ReadGnssFile(const fs::path& path, const UtmZone& zone) {
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
      reading.fixes.push_back(Locate(row, zone));
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
  std::error_code ignored;
  const fs::path degrees = part_folder / "gps-latlong.txt";
  if (fs::is_regular_file(degrees, ignored)) return ReadGnssFile(degrees);
  std::map<fs::path, UtmZone> grids;
  for (const auto& entry : fs::directory_iterator(part_folder, ignored)) {
    const auto zone = ZoneInName(entry.path().filename().string());
    if (zone && entry.is_regular_file(ignored)) grids.emplace(entry.path(), *zone);
  }
  if (grids.empty()) return std::nullopt;
  return ReadGnssFile(grids.begin()->first, grids.begin()->second);
}

}  // namespace rigmap
