#include "georeference/utm.h"

#include <fmt/format.h>

#include <GeographicLib/Math.hpp>
#include <GeographicLib/TransverseMercator.hpp>
#include <cmath>
#include <numbers>

#include "core/error.h"

namespace rigmap {
namespace {

constexpr double kCentralMeridian_deg = 3.0;
constexpr double kFalseEasting_m = 500'000.0;
constexpr double kReach_deg = 30.0;  // the series behind it holds to nanometres up to 35
constexpr double kWidest_m = 3.5e6;  // 30 degrees of longitude on the equator are 3.49e6 m of grid
constexpr double kPole_m = 1.0e7;    // a quarter of the meridian, times the scale of 0.9996

bool WithinReach(double longitude_deg) {
  return std::abs(GeographicLib::Math::AngDiff(kCentralMeridian_deg, longitude_deg)) <= kReach_deg;
}

}  // namespace

UtmPoint ToUtm31(const Geodetic& position) {
  RequireValid(position);
  if (!WithinReach(position.longitude_deg)) {
    throw DataError(fmt::format("expected a longitude within {} degrees of 3 for UTM 31, found {}",
                                kReach_deg, position.longitude_deg));
  }
  UtmPoint point;
  double convergence_deg = 0.0;
  GeographicLib::TransverseMercator::UTM().Forward(kCentralMeridian_deg, position.latitude_deg,
                                                   position.longitude_deg, point.easting_m,
                                                   point.northing_m, convergence_deg, point.scale);
  point.easting_m += kFalseEasting_m;
  point.convergence_rad = convergence_deg * std::numbers::pi / 180.0;
  return point;
}

Geodetic FromUtm31(double easting_m, double northing_m, double altitude_m) {
  const double from_meridian_m = easting_m - kFalseEasting_m;
  const bool on_grid = std::abs(from_meridian_m) <= kWidest_m && std::abs(northing_m) <= kPole_m;
  Geodetic position{0.0, 0.0, altitude_m};
  if (on_grid) {
    GeographicLib::TransverseMercator::UTM().Reverse(kCentralMeridian_deg, from_meridian_m,
                                                     northing_m, position.latitude_deg,
                                                     position.longitude_deg);
  }
  if (!on_grid || !std::isfinite(altitude_m) || !WithinReach(position.longitude_deg)) {
    throw DataError(fmt::format(
        "expected easting, northing and altitude of a place within {} degrees of longitude 3, "
        "found {}, {}, {}",
        kReach_deg, easting_m, northing_m, altitude_m));
  }
  return position;
}

}  // namespace rigmap
