// What is not to be trusted says so in every file that can.
#pragma once

#include <filesystem>

#include "pipeline/ledger.h"

namespace rigmap {

// Puts into the headers of the clouds, trajectories (TUM, KITTI), pose graphs and rig files that
// the ledger speaks of why they are not to be trusted, and takes that away from those that are.
// Files made after the gates were checked bear it from the start (the stages `raster` and `views`).
// Those of results of which no gate was checked stay as they are.
void MarkOutputs(const std::filesystem::path& root, const Ledger& ledger);

}  // namespace rigmap
