// Rows of words and numbers, as Katwijk's text files hold them.
#pragma once

#include <optional>
#include <string_view>

#include "core/stamp.h"
#include "georeference/utm_grid.h"

namespace rigmap {

// Cuts the next word off `line`, at blanks, tabs or a carriage return; empty at its end.
std::string_view NextWord(std::string_view& line);

// The whole word as a finite number, as a stamp of Katwijk's; nothing if it is none.
std::optional<double> ParseFinite(std::string_view word);
std::optional<StampNs> ParseStamp(std::string_view word);

// Which column of a pair of metres of a zone is the northing: UTM eastings lie between 100 and 900
// km, northings may be larger or smaller. Between 0.9 and 8.1 degrees north both columns may be
// either.
enum class GridColumns { kEastingFirst, kNorthingFirst, kEither };

// Nothing for two numbers that are no such place. Of a column that may be either, that order alone
// of which the place lies in the zone that maps of it are drawn in.
std::optional<GridColumns> GridColumnsOf(double first, double second, const UtmZone& zone);

// Whether two northings can be of one drive, or of what is surveyed beside it.
bool AreNear(double northing_m, double other_northing_m);

}  // namespace rigmap
