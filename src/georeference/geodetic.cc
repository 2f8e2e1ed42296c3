#include "georeference/geodetic.h"

#include <fmt/format.h>

#include <cmath>

#include "core/error.h"

namespace rigmap {

void RequireValid(const Geodetic& position) {
  const bool finite = std::isfinite(position.latitude_deg) &&
                      std::isfinite(position.longitude_deg) && std::isfinite(position.altitude_m);
  if (finite && std::abs(position.latitude_deg) <= 90.0) return;
  throw DataError(
      fmt::format("expected a finite longitude and altitude and a latitude within 90 degrees, "
                  "found latitude {}, longitude {}, altitude {} m",
                  position.latitude_deg, position.longitude_deg, position.altitude_m));
}

}  // namespace rigmap
