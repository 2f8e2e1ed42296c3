#include "dataset/internal/gnss_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <regex>
#include <sstream>
#include <string_view>

#include "core/error.h"
#include "core/file.h"
#include "core/statistics.h"
#include "dataset/internal/text_row.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kExpectedRow =
    "stamp, status, latitude and longitude or UTM metres, altitude and three sigmas";

enum class Coordinates { kLatitudeFirst, kEastingFirst, kNorthingFirst, kEitherGrid };

struct Row {
  int line = 0;
  std::string text;
  std::optional<Coordinates> coordinates;  // nothing: malformed
  GnssFix fix;                             // latitude and longitude not yet set
  double first = 0.0, second = 0.0;
};

std::optional<Coordinates> CoordinatesOf(double first, double second, const UtmZone& zone) {
  if (first == 0.0 && second == 0.0) return std::nullopt;  // a receiver that has no position yet
  if (std::abs(first) <= 90.0 && std::abs(second) <= 180.0) return Coordinates::kLatitudeFirst;
  const auto columns = GridColumnsOf(first, second, zone);
  if (!columns) return std::nullopt;
  if (*columns == GridColumns::kEither) return Coordinates::kEitherGrid;
  return *columns == GridColumns::kEastingFirst ? Coordinates::kEastingFirst
                                                : Coordinates::kNorthingFirst;
}

// Receivers' programs differ in case.
std::string StatusOf(std::string_view word) {
  std::string status(word);
  std::ranges::transform(status, status.begin(), [](unsigned char letter) {
    return static_cast<char>(std::toupper(letter));
  });
  return status;
}

Row ParseFix(const std::string& text, int line, const UtmZone& zone) {
  Row row{.line = line, .text = text};
  std::string_view rest = text;
  const auto stamp_ns = ParseStamp(NextWord(rest));
  row.fix.status = StatusOf(NextWord(rest));
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
  row.coordinates = CoordinatesOf(first, second, zone);
  return row;
}

std::vector<Row> ParseRows(const std::string& text, const UtmZone& zone) {
  std::vector<Row> rows;
  std::istringstream stream(text);
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    std::string_view words = line;
    if (!NextWord(words).empty()) rows.push_back(ParseFix(line, number, zone));
  }
  return rows;
}

std::optional<Coordinates> MostFrequent(const std::vector<Row>& rows) {
  std::array<int, 4> counts{};
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

double Northing(const Row& row, Coordinates order) {
  return order == Coordinates::kEastingFirst ? row.second : row.first;
}

// Rows of this order, those of a grid all within the reach of one drive.
std::vector<char> AreOfOrder(const std::vector<Row>& rows, Coordinates order) {
  const bool is_grid = order != Coordinates::kLatitudeFirst;
  std::vector<char> are(rows.size(), 0);
  std::vector<double> northings_m;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    are[i] = rows[i].coordinates == order ||
             (is_grid && rows[i].coordinates == Coordinates::kEitherGrid);
    if (are[i]) northings_m.push_back(Northing(rows[i], order));
  }
  if (!is_grid) return are;
  const double middle_m = Median(std::move(northings_m));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    are[i] = are[i] && AreNear(Northing(rows[i], order), middle_m);
  }
  return are;
}

GnssFix Locate(const Row& row, Coordinates order, const UtmZone& zone) {
  GnssFix fix = row.fix;
  fix.latitude_deg = row.first;
  fix.longitude_deg = row.second;
  if (order == Coordinates::kLatitudeFirst) return fix;
  const double northing_m = Northing(row, order);
  const double easting_m = order == Coordinates::kEastingFirst ? row.first : row.second;
  const Geodetic position = FromUtm(zone, easting_m, northing_m, fix.altitude_m);
  fix.latitude_deg = position.latitude_deg;
  fix.longitude_deg = position.longitude_deg;
  return fix;
}

// Of fixes of one stamp the first stays.
void LeaveOutRepeats(const fs::path& path, GnssReading& reading) {
  std::ranges::stable_sort(reading.fixes, {}, &GnssFix::stamp_ns);
  const auto repeats = std::ranges::unique(reading.fixes, {}, &GnssFix::stamp_ns);
  if (repeats.empty()) return;
  reading.remarks.push_back(fmt::format("{}: {} of {} rows repeat a stamp and are left out",
                                        path.string(), repeats.size(), reading.fixes.size()));
  reading.fixes.erase(repeats.begin(), repeats.end());
}

}  // namespace

GnssReading ReadGnssFile(const fs::path& path, const UtmZone& zone) {
  const std::vector<Row> rows = ParseRows(ReadTextFile(path), zone);
  const auto found = MostFrequent(rows);
  if (!found) {
    const Row first = rows.empty() ? Row{.line = 1} : rows.front();
    throw DataError(fmt::format("{}:{}: expected rows of {}, found '{}'", path.string(), first.line,
                                kExpectedRow, first.text));
  }
  const bool is_open = *found == Coordinates::kEitherGrid;
  const Coordinates order = is_open ? Coordinates::kEastingFirst : *found;
  const std::vector<char> are_of_order = AreOfOrder(rows, order);
  GnssReading reading;
  std::vector<const Row*> left_out;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (are_of_order[i]) {
      reading.fixes.push_back(Locate(rows[i], order, zone));
    } else {
      left_out.push_back(&rows[i]);
    }
  }
  if (is_open) {
    reading.remarks.push_back(
        fmt::format("{}: either column may be the northing; the first is taken for the easting",
                    path.string()));
  }
  LeaveOutRepeats(path, reading);
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
