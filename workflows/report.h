// `rigmap report`, and the report at the end of a run.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scene/dataset.h"

namespace rigmap {

// Writes report.html into each folder, all of them before it returns, and returns a line for each:
// its path. Throws DataError for the first folder without a finished result, before any is written.
std::string WriteReports(const std::vector<std::filesystem::path>& folders);

// At the end of a run of any status: of what lies in the locked folder. `dataset`: where its images
// are, if the run came to know. What goes wrong is a warning: a report is no reason for a run to
// fail.
void TryToWriteReport(const std::filesystem::path& folder, const Dataset* dataset);

}  // namespace rigmap
