// The stage `mapping`: COLMAP poses the keyframes, in its own gauge.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "colmap/installation.h"
#include "mapping/mapping_options.h"
#include "mapping/seed_model.h"
#include "scene/mapping_result.h"

namespace rigmap {

struct MappingPaths {
  std::filesystem::path database, images;
  std::filesystem::path models;   // replaced; sub-models are left in models/0, models/1, ...
  std::filesystem::path scratch;  // on the models' file system; may be removed afterwards
  std::filesystem::path log;
};

// Seeds the mapper with a metric model of the keyframes that share most tracks and lets it go on;
// where it stops with keyframes left, seeds anew there. When COLMAP makes no model, seeded or not,
// the odometric poses are triangulated instead, and a remark says so. Throws ToolError when COLMAP
// cannot be run.
MappingResult MapKeyframes(const ColmapInstallation& colmap, const GraphWithPoses& input,
                           const MappingPaths& paths, const MappingOptions& options, int threads);

}  // namespace rigmap
