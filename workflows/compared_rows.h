// The rows of a comparison, of runs that are there.
#pragma once

#include <filesystem>
#include <vector>

#include "workflows/comparison.h"

namespace rigmap {

// Of every run below out/runs, whichever call of compare has made it, by part, technique, setting
// and repeat. A file that holds no row is named in a warning and left out.
std::vector<ComparisonRow> StoredRows(const std::filesystem::path& out);

// Of results that lie anywhere, in the same order: those of the same frames share a part, named
// after these, and options that are no default are their setting. What is alike but for its folder
// bears the folder's name, too. Throws UsageError for a folder that is given twice, DataError where
// one holds no result.
std::vector<ComparisonRow> RowsOf(const std::vector<std::filesystem::path>& outs);

}  // namespace rigmap
