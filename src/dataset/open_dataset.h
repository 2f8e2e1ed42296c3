// From a folder to a Dataset: recognises the form, finds the rig, checks that they fit.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "scene/dataset.h"

namespace rigmap {

struct DatasetRequest {
  std::filesystem::path folder;               // Katwijk root, traverse or part, or stereo folder
  std::optional<int> traverse, part;          // Katwijk only; may be left out where unambiguous
  std::optional<std::filesystem::path> rig;   // rig file that overrides those beside the data
  std::optional<std::string> format;          // "katwijk" or "stereo"; nothing: recognised
  std::optional<std::pair<int, int>> frames;  // FIRST and END of the paired frames, half open
  std::filesystem::path default_loccam_rig;   // for Katwijk data without a rig file of its own
};

// The data sets that a request may mean, one for each part of a traverse: a stereo folder is one;
// of a Katwijk root or traverse each part that fits, in order. Throws as OpenDataset, and
// UsageError where parts of several traverses fit.
std::vector<DatasetRequest> PartsOf(const DatasetRequest& request);

// The rig is request.rig; else calib.yaml or rig.yaml in the given folder or, for Katwijk, in the
// part's folder or the two above it; else, for Katwijk, default_loccam_rig. Which one applies is
// logged, and so is what was wrong with the data. Paths in the result are absolute.
// Throws UsageError for a part, format or frame range that is not there, listing what is; DataError
// for data that cannot be used, also when no pair can be read, or the first that can or a mask is
// not of the rig's size.
Dataset OpenDataset(const DatasetRequest& request);

}  // namespace rigmap
