#include "georeference/geodetic.h"

#include <fmt/format.h>

#include <cmath>

#include "core/error.h"

namespace rigmap {

void RequireValid(const Geodetic& place) {
  const bool finite = std::isfinite(place.latitude_deg) && std::isfinite(place.longitude_deg) &&
                      std::isfinite(place.altitude_m);
  if (finite && std::abs(place.latitude_deg) <= 90.0) return;
  throw DataError(
      fmt::format("expected a finite longitude and altitude and a latitude within 90 degrees, "
                  "found latitude {}, longitude {}, altitude {} m",
                  place.latitude_deg, place.longitude_deg, place.altitude_m));
}

}  // namespace rigmap
