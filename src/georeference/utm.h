// UTM zone 31 north on WGS84 (EPSG:32631), the map grid that Katwijk's rocks are surveyed in.
#pragma once

#include "georeference/geodetic.h"

namespace rigmap {

inline constexpr int kUtm31Epsg = 32631;

struct UtmPoint {
  double easting_m = 0.0;   // 500 000 on the central meridian, 3 degrees east
  double northing_m = 0.0;  // 0 on the equator, negative south of it
  // Bearing of grid north, clockwise from true north: positive east of 3 degrees on the northern
  // half. A short way of true east e and north n changes the easting by
  // scale (e cos(convergence) - n sin(convergence)), the northing by
  // scale (e sin(convergence) + n cos(convergence)).
  double convergence_rad = 0.0;
  double scale = 1.0;  // grid metres per metre on the ellipsoid; heights do not enter
};

// Zone 31 whatever the longitude, to nanometres as far as 30 degrees from the central meridian;
// throws DataError beyond and as RequireValid does.
UtmPoint ToUtm31(const Geodetic& position);

// The inverse, with the altitude given. Throws DataError for what ToUtm31 cannot have given.
Geodetic FromUtm31(double easting_m, double northing_m, double altitude_m);

}  // namespace rigmap
