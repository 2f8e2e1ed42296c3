// The satellite fixes of a part in Katwijk's form, gps-latlong.txt and gps-utm31.txt. A row: stamp,
// status, latitude and longitude (degrees), altitude (m above the ellipsoid), sigmas north, east,
// up (m), separated by blanks. gps-utm31.txt should hold metres of UTM 31N in place of the degrees,
// in either order, but the published ones hold degrees: the values decide, for the file as a whole;
// where they could be either, between 0.9 and 8.1 degrees north, the easting is the first.
// Files of other zones are called so, too: gps-utm10.txt, gps-utm19s.txt south of the equator.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "georeference/utm_grid.h"
#include "scene/survey.h"

namespace rigmap {

struct GnssReading {
  std::vector<GnssFix> fixes;  // in order of stamps
  // Sentences: where the order of the columns is open; if rows were left out how many, and the
  // first with its line, what was expected and what was found.
  std::vector<std::string> remarks;
};

// The part's gps-latlong.txt, else its first gps-utmZONE.txt; nothing if it has neither.
std::optional<GnssReading> ReadGnss(const std::filesystem::path& part_folder);

// One such file, with metres of this zone. Rows that are malformed, or of another kind of
// coordinates than most, or more than 100 km of northing from them, are left out. Throws DataError
// if the file cannot be read or has no row that can be used.
GnssReading ReadGnssFile(const std::filesystem::path& path, const UtmZone& zone = {});

}  // namespace rigmap
