// Structure from motion as COLMAP does it by itself: left and right images as if of cameras that
// have nothing to do with each other, with COLMAP's own features, matches and options.
#pragma once

#include <filesystem>
#include <vector>

#include "colmap/installation.h"
#include "core/options.h"
#include "scene/dataset.h"
#include "scene/mapping_result.h"

namespace rigmap {

// What each option does and why it has its default: the declarations in free_cameras.cc. Apart, so
// that another seed does not match anew.
struct FreeMatchingOptions {
  static constexpr const char* kSection = "sfm";

  int overlap = 5;

  OptionFields Fields();
};

struct FreeMappingOptions {
  static constexpr const char* kSection = "sfm";

  bool refine_intrinsics = true;
  int random_seed = 0;
  double max_mapping_s = 3600.0;

  OptionFields Fields();
};

struct FreeCameraPaths {
  std::filesystem::path database, images;
  std::filesystem::path scratch;  // may be removed afterwards
  std::filesystem::path log;
};

// Pairs of images that are compared, by their names: both images of a frame with each other and
// with those of the next `overlap` frames, and of the frames twice, four times, ... as far, as
// COLMAP's matcher for videos does it.
std::vector<std::pair<std::string, std::string>> ImagePairs(const std::vector<StereoFrame>& frames,
                                                            int overlap);

// Makes the database: every image, the rig's intrinsics, COLMAP's features and matches. Returns how
// many pairs were compared. Throws ToolError when COLMAP fails.
std::size_t MatchFreeCameras(const ColmapInstallation& colmap, const Dataset& dataset,
                             const FreeCameraPaths& paths, const FreeMatchingOptions& options,
                             int threads);

// Models in `models`/0, 1, ..., largest first, whose images name the dataset's frames. A remark
// instead where COLMAP makes none, in time or at all.
MappingResult MapFreeCameras(const ColmapInstallation& colmap, const FreeCameraPaths& paths,
                             const std::filesystem::path& models, const FreeMappingOptions& options,
                             std::size_t frame_count, int threads);

}  // namespace rigmap
