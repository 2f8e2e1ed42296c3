// COLMAP's own features and matches, at its defaults, on the CPU.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <utility>

#include "colmap/installation.h"

namespace rigmap {

struct OwnMatchingRequest {
  std::filesystem::path database;  // holds cameras and images, of which none has keypoints
  std::filesystem::path images;    // folder that the database's image names are relative to
  std::filesystem::path log;       // appended to
  int threads = 1;
  std::function<void(int done)> on_progress = {};  // images, or pairs of images
};

// Fills the database with SIFT keypoints and descriptors of every image (8192 at most). Throws
// ToolError when COLMAP fails.
void RunFeatureExtractor(const ColmapInstallation& colmap, const OwnMatchingRequest& request);

// Compares all descriptors of these pairs of images, by name, and verifies what matches by a
// two-view geometry. `pair_list` is where their names are written for COLMAP. Throws ToolError when
// it fails, DataError where the list cannot be written.
void RunMatchesImporter(const ColmapInstallation& colmap, const OwnMatchingRequest& request,
                        std::span<const std::pair<std::string, std::string>> pairs,
                        const std::filesystem::path& pair_list);

}  // namespace rigmap
