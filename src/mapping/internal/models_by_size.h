// Models in numbered folders.
#pragma once

#include <filesystem>
#include <vector>

#include "scene/sparse_model.h"

namespace rigmap {

struct MadeModel {
  std::filesystem::path folder;
  SparseModel model;
};

// Moves their folders to `models`/0, 1, ..., by number of images, the largest first. `models` is
// made; what was numbered there before must be gone.
std::vector<SparseModel> NumberBySize(std::vector<MadeModel> made,
                                      const std::filesystem::path& models);

}  // namespace rigmap
