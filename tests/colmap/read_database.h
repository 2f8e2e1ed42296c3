// COLMAP's database read back, to see what was written.
#pragma once

#include <filesystem>

#include "colmap/database.h"

namespace rigmap {

// What a database holds, in order of images; pairs come from two_view_geometries and have
// image_a < image_b. Throws std::exception for one that is not as WriteDatabase leaves it.
DatabaseContent ReadDatabase(const std::filesystem::path& path);

}  // namespace rigmap
