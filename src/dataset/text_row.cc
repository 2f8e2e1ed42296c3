#include "dataset/internal/text_row.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/error.h"

namespace rigmap {
namespace {

constexpr std::string_view kBlanks = " \t\r";
constexpr double kMinEasting_m = 1.0e5, kMaxEasting_m = 9.0e5, kMaxNorthing_m = 1.0e7;
constexpr double kSouthernCap_m = 9.0e5;  // beyond 80 degrees south there are no zones
constexpr double kLongestWay_m = 1.0e5;

bool IsEasting(double metres) { return metres >= kMinEasting_m && metres <= kMaxEasting_m; }
bool IsNorthing(double metres, const UtmZone& zone) {
  return metres >= (zone.north ? 0.0 : kSouthernCap_m) && metres <= kMaxNorthing_m;
}

bool IsInZone(const UtmZone& zone, double easting_m, double northing_m) {
  const Geodetic position = FromUtm(zone, easting_m, northing_m, 0.0);
  return HasUtmZone(position) && UtmZoneOf(position).number == zone.number;
}

}  // namespace

std::string_view NextWord(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(kBlanks), line.size()));
  const auto word = line.substr(0, line.find_first_of(kBlanks));
  line.remove_prefix(word.size());
  return word;
}

std::optional<double> ParseFinite(std::string_view word) {
  double value = 0.0;
  const char* end = word.data() + word.size();
  const auto result = std::from_chars(word.data(), end, value);
  const bool whole = !word.empty() && result.ec == std::errc() && result.ptr == end;
  return whole && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

std::optional<StampNs> ParseStamp(std::string_view word) {
  try {
    return ParseKatwijkStamp(word);
  } catch (const DataError&) {
    return std::nullopt;
  }
}

std::optional<GridColumns> GridColumnsOf(double first, double second, const UtmZone& zone) {
  bool easting_first = IsEasting(first) && IsNorthing(second, zone);
  bool northing_first = IsNorthing(first, zone) && IsEasting(second);
  if (easting_first && northing_first) {
    const bool in_zone = IsInZone(zone, first, second);
    if (in_zone != IsInZone(zone, second, first)) {
      easting_first = in_zone;
      northing_first = !in_zone;
    }
  }
  if (easting_first && northing_first) return GridColumns::kEither;
  if (easting_first) return GridColumns::kEastingFirst;
  if (northing_first) return GridColumns::kNorthingFirst;
  return std::nullopt;
}

bool AreNear(double northing_m, double other_northing_m) {
  return std::abs(northing_m - other_northing_m) <= kLongestWay_m;
}

}  // namespace rigmap
