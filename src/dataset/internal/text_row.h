// Rows of words and numbers, as Katwijk's text files hold them.
#pragma once

#include <optional>
#include <string_view>

#include "core/stamp.h"

namespace rigmap {

// Cuts the next word off `line`, at blanks, tabs or a carriage return; empty at its end.
std::string_view NextWord(std::string_view& line);

// The whole word as a finite number, as a stamp of Katwijk's; nothing if it is none.
std::optional<double> ParseFinite(std::string_view word);
std::optional<StampNs> ParseStamp(std::string_view word);

// Which column of a pair of metres is the northing: UTM eastings lie between 100 and 900 km, places
// north of 8.2 degrees, and all of the southern half but its polar cap, have northings beyond 900
// km.
enum class GridColumns { kEastingFirst, kNorthingFirst };

// Nothing for two numbers that are no such place.
std::optional<GridColumns> GridColumnsOf(double first, double second);

}  // namespace rigmap
