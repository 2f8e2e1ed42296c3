// A recipe's run in an output folder: claims the folder, does what is missing, says what it is
// worth.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "core/job.h"
#include "dataset/dataset_content.h"
#include "pipeline/stage_graph.h"
#include "scene/dataset.h"
#include "workflows/output_folder.h"
#include "workflows/part_request.h"
#include "workflows/reconstruct_part.h"

namespace rigmap {

struct FolderRun {
  const PartRequest& request;  // all but where the data come from, and the technique
  std::string name;            // of the recipe
  std::function<StageGraph(const Dataset&, const DatasetContent&)> recipe;
  std::optional<FolderMark> mark = {};  // nothing: that of the data
};

// In an output folder, the hashes of the files that its results were made from.
std::filesystem::path HashesPath(const std::filesystem::path& root);

// As ReconstructPart, which is this with a part's data and a technique's recipe.
PartResult RunInFolder(const FolderRun& run, Dataset dataset, Job& job);

}  // namespace rigmap
