// The map grids of WGS84 / UTM: sixty zones, each with a northern and a southern half.
#pragma once

#include <optional>
#include <string>

#include "georeference/geodetic.h"
#include "georeference/utm.h"

namespace rigmap {

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

// The zone that maps of a place are drawn in, with the exceptions of Norway and Svalbard; the
// equator is north. Throws DataError beyond 80 degrees south and 84 north, where there is none, and
// as RequireValid does.
bool HasUtmZone(const Geodetic& position);
// The zone of an EPSG number, 32601 to 32660 and 32701 to 32760; nothing for another grid.
std::optional<UtmZone> UtmZoneOfEpsg(int epsg);
UtmZone UtmZoneOf(const Geodetic& position);

// Metres of this zone, southern northings counted from 10 000 km; to nanometres as far as 30
// degrees from the central meridian. Throws DataError beyond and as RequireValid does.
UtmPoint ToUtm(const UtmZone& zone, const Geodetic& position);

// The inverse, with the altitude given. Throws DataError for what ToUtm cannot have given.
Geodetic FromUtm(const UtmZone& zone, double easting_m, double northing_m, double altitude_m);

}  // namespace rigmap
