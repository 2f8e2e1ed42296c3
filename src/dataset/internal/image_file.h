// Image files as they lie in a folder.
#pragma once

#include <filesystem>
#include <vector>

namespace rigmap {

// The files of `folder` that end in png, jpg, jpeg, pgm, ppm, tif or tiff (any case), sorted by
// name; hidden ones are left out. Empty if there is no such folder. Throws DataError if it cannot
// be listed.
std::vector<std::filesystem::path> ListImages(const std::filesystem::path& folder);

}  // namespace rigmap
