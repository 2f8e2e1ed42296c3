// The map grids of WGS84 / UTM: sixty zones, each with a northern and a southern half.
#pragma once

#include <optional>
#include <string>

#include "georeference/geodetic.h"

namespace rigmap {

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

struct UtmZone {
  int number = 31;  // 1 to 60
  bool north = true;

  int Epsg() const { return (north ? 32600 : 32700) + number; }
  std::string Name() const;        // "31N"
  double CentralMeridian() const;  // degrees
  double FalseNorthing() const;    // metres
  bool operator==(const UtmZone&) const = default;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(number, north);
  }
};

inline constexpr UtmZone kUtm31{31, true};  // that Katwijk's rocks are surveyed in

// Whether a place lies between 80 degrees south and 84 north, beyond which there are no zones.
bool HasUtmZone(const Geodetic& position);
// The zone that maps of a place are drawn in, with the exceptions of Norway and Svalbard; the
// equator is north. Throws DataError where there is none, and as RequireValid does.
UtmZone UtmZoneOf(const Geodetic& position);
// The zone of an EPSG number, 32601 to 32660 and 32701 to 32760; nothing for another grid.
std::optional<UtmZone> UtmZoneOfEpsg(int epsg);

// Metres of this zone, southern northings counted from 10 000 km; to nanometres as far as 30
// degrees from the central meridian. Throws DataError beyond and as RequireValid does.
UtmPoint ToUtm(const UtmZone& zone, const Geodetic& position);

// The inverse, with the altitude given. Throws DataError for what ToUtm cannot have given.
Geodetic FromUtm(const UtmZone& zone, double easting_m, double northing_m, double altitude_m);

}  // namespace rigmap
