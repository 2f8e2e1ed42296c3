#include "georeference/utm_grid.h"

#include <fmt/format.h>

#include <GeographicLib/Math.hpp>
#include <GeographicLib/TransverseMercator.hpp>
#include <GeographicLib/UTMUPS.hpp>
#include <cmath>
#include <numbers>

#include "core/error.h"

namespace rigmap {
namespace {

constexpr double kGridFalseEasting_m = 500'000.0;
constexpr double kMaxFromMeridian_deg = 30.0;  // the series behind it holds to nanometres up to 35
constexpr double kMaxFromMeridian_m = 3.5e6;   // 30 degrees on the equator are 3.49e6 m of grid
constexpr double kGridPole_m = 1.0e7;  // a quarter of the meridian, times the scale of 0.9996

bool IsNear(const UtmZone& zone, double longitude_deg) {
  return std::abs(GeographicLib::Math::AngDiff(zone.CentralMeridian(), longitude_deg)) <=
         kMaxFromMeridian_deg;
}

}  // namespace

std::string UtmZone::Name() const { return fmt::format("{}{}", number, north ? "N" : "S"); }

double UtmZone::CentralMeridian() const { return 6.0 * number - 183.0; }

double UtmZone::FalseNorthing() const { return north ? 0.0 : kGridPole_m; }

bool HasUtmZone(const Geodetic& position) {
  return position.latitude_deg >= -80.0 && position.latitude_deg < 84.0;
}

std::optional<UtmZone> UtmZoneOfEpsg(int epsg) {
  for (const bool north : {true, false}) {
    const UtmZone zone{epsg - UtmZone{0, north}.Epsg(), north};
    if (zone.number >= 1 && zone.number <= 60) return zone;
  }
  return std::nullopt;
}

UtmZone UtmZoneOf(const Geodetic& position) {
  RequireValid(position);
  const double latitude_deg = position.latitude_deg;
  if (!HasUtmZone(position)) {
    throw DataError(
        fmt::format("expected a latitude from -80 to 84 degrees for UTM, found {}", latitude_deg));
  }
  const int number = GeographicLib::UTMUPS::StandardZone(latitude_deg, position.longitude_deg);
  return {number, latitude_deg >= 0.0};
}

UtmPoint ToUtm(const UtmZone& zone, const Geodetic& position) {
  RequireValid(position);
  if (!IsNear(zone, position.longitude_deg)) {
    throw DataError(fmt::format("expected a longitude within {} degrees of {} for UTM {}, found {}",
                                kMaxFromMeridian_deg, zone.CentralMeridian(), zone.Name(),
                                position.longitude_deg));
  }
  UtmPoint point;
  double convergence_deg = 0.0;
  GeographicLib::TransverseMercator::UTM().Forward(zone.CentralMeridian(), position.latitude_deg,
                                                   position.longitude_deg, point.easting_m,
                                                   point.northing_m, convergence_deg, point.scale);
  point.easting_m += kGridFalseEasting_m;
  point.northing_m += zone.FalseNorthing();
  point.convergence_rad = convergence_deg * std::numbers::pi / 180.0;
  return point;
}

Geodetic FromUtm(const UtmZone& zone, double easting_m, double northing_m, double altitude_m) {
  const double from_meridian_m = easting_m - kGridFalseEasting_m;
  const double from_equator_m = northing_m - zone.FalseNorthing();
  const bool on_grid =
      std::abs(from_meridian_m) <= kMaxFromMeridian_m && std::abs(from_equator_m) <= kGridPole_m;
  Geodetic position{0.0, 0.0, altitude_m};
  if (on_grid) {
    GeographicLib::TransverseMercator::UTM().Reverse(zone.CentralMeridian(), from_meridian_m,
                                                     from_equator_m, position.latitude_deg,
                                                     position.longitude_deg);
  }
  if (!on_grid || !std::isfinite(altitude_m) || !IsNear(zone, position.longitude_deg)) {
    throw DataError(fmt::format(
        "expected easting, northing and altitude of a place within {} degrees of longitude {}, "
        "found {}, {}, {}",
        kMaxFromMeridian_deg, zone.CentralMeridian(), easting_m, northing_m, altitude_m));
  }
  return position;
}

}  // namespace rigmap
