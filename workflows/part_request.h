// What `rigmap part` was asked to do.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "dataset/open_dataset.h"
#include "workflows/part_options.h"
#include "workflows/recipes.h"

namespace rigmap {

struct PartRequest {
  DatasetRequest dataset;
  std::filesystem::path out;
  Technique technique = Technique::kRig;
  PartOptions options;
  std::optional<std::string> until, from;  // stage names of the technique
  bool force = false;                      // empty the output folder first
  bool take_up_frames = true;              // RunPlan::take_up_frames
  int threads = 2;
  int memory_mb = 2048;                        // bounds how many frames are at work at once
  int sharing = 1;                             // parts at work at the same time in this process
  std::optional<std::filesystem::path> truth;  // TUM file, or folder with trajectory.tum
  bool quiet = false;
  std::string command;  // as typed, for summary.json
};

// The number of the first frame that was asked for.
inline int FirstFrame(const PartRequest& request) {
  return request.dataset.frames ? request.dataset.frames->first : 0;
}

}  // namespace rigmap
