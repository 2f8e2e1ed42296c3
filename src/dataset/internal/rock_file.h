// Surveyed rocks, as Katwijk's lie:
//   <root>/Rock Data/Rock Positions Traverse 1 and 2/{small,medium,large}-rocks-traverse12.txt
//   <root>/Rock Data/Rock Positions Traverse 3/{small,medium,large}-rocks-traverse3.txt
// A row is a rock: easting and northing, or northing and easting, in metres of a UTM zone,
// Katwijk's being 31N, separated by blanks. Which is which is decided from the values; easting
// first where they could be either, near the equator.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "dataset/internal/katwijk.h"
#include "georeference/utm_grid.h"
#include "scene/survey.h"

namespace rigmap {

// The rocks of the part's traverse, of the kinds "small", "medium" and "large", from a folder `Rock
// Data` beside the part or its traverse. Empty where there is none, or where the traverse is
// unknown and both lists are there. Throws DataError as ReadRockFile does.
std::vector<SurveyedLandmark> ReadRockSurvey(const KatwijkPart& part, const UtmZone& zone = {});

// One file, whose rocks are all of this kind; empty lines are passed over. Throws DataError naming
// file, line, what was expected and found for a row that is no place of the zone, has its columns
// the other way round than the first one, or lies more than 100 km from it.
std::vector<SurveyedLandmark> ReadRockFile(const std::filesystem::path& path,
                                           const std::string& kind, const UtmZone& zone = {});

}  // namespace rigmap
