// Which file a --truth means.
#pragma once

#include <filesystem>
#include <optional>

#include "dataset/open_dataset.h"

namespace rigmap {

// The file that a --truth names: itself, or in a folder trajectory.tum, groundtruth_tum.txt or
// groundtruth_xy.txt, a prism's track. Throws DataError if the folder holds none.
std::filesystem::path TruthFile(const std::filesystem::path& truth);

// The same for a traverse: a file, or a folder with trajectory.tum or one for each of its parts.
std::filesystem::path WholeTruth(const std::filesystem::path& truth);

// What --truth means for one part: of a folder with some of parts its own, if it has one.
std::optional<std::filesystem::path> TruthOfPart(const std::optional<std::filesystem::path>& truth,
                                                 const DatasetRequest& part);
// The file of the truth (TruthFile) for a run of the part that the request names, if it names one.
std::filesystem::path TruthOfRun(const std::filesystem::path& truth, const DatasetRequest& part);

}  // namespace rigmap
