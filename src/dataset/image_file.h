// Image files as they lie in a folder: which there are, and whether all of each is there.
#pragma once

#include <filesystem>
#include <vector>

namespace rigmap {

// The files of `folder` that end in png, jpg, jpeg, pgm, ppm, tif or tiff (any case), sorted by
// name; hidden ones are left out. Empty if there is no such folder. Throws DataError if it cannot
// be listed.
std::vector<std::filesystem::path> ListImages(const std::filesystem::path& folder);

// True if the file is an image with its end in place. PNG and JPEG are judged by their first and
// last bytes (microseconds; damage in between is not seen), other formats are decoded.
bool IsWholeImage(const std::filesystem::path& path);

}  // namespace rigmap
