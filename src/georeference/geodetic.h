// Places on the Earth: latitude and longitude on WGS84 and the height above its ellipsoid.
#pragma once

namespace rigmap {

struct Geodetic {
  double latitude_deg = 0.0;   // north positive, -90 to 90
  double longitude_deg = 0.0;  // east positive
  double altitude_m = 0.0;     // above the ellipsoid, not above the sea
};

// Throws DataError unless all three are finite and the latitude lies within 90 degrees.
void RequireValid(const Geodetic& position);

}  // namespace rigmap
