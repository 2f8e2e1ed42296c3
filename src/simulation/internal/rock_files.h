// The surveyed boulders in Katwijk's form:
//   <root>/Rock Data/Rock Positions Traverse 1 and 2/{small,medium,large}-rocks-traverse12.txt
//   <root>/Rock Data/Rock Positions Traverse 3/{small,medium,large}-rocks-traverse3.txt
// A row is easting and northing in UTM 31N, metres with three decimals.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "georeference/local_frame.h"
#include "simulation/boulders.h"

namespace rigmap {

constexpr double kRockSurveySigma_m = 0.03;  // of easting and northing each

// Writes the three files under the data set's root, rows in the order of `boulders`, which has no
// size but small, medium and large. `traverse` is 1, 2 or 3; the first two share their files.
// Equal seeds give equal errors of the survey. Throws UsageError for another traverse, DataError
// when a file cannot be written.
void WriteRockFiles(const std::filesystem::path& root, int traverse,
                    std::span<const Boulder> boulders, const LocalFrame& local, std::uint64_t seed);

}  // namespace rigmap
