#include "workflows/reconstruct_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <opencv2/core.hpp>

#include "core/error.h"
#include "dataset/open_dataset.h"
#include "workflows/run_in_folder.h"
#include "workflows/stages/compare_result.h"
#include "workflows/stages/dense_memory.h"
#include "workflows/stages/features.h"
#include "workflows/stages/fusion.h"
#include "workflows/truth_files.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

// The dataset with the truth that it is to be compared with, which can be read. Known to be wrong
// now, not when all work is done.
Dataset OpenWithTruth(const PartRequest& request) {
  Dataset dataset = OpenDataset(request.dataset);
  if (request.truth)
    dataset.truth_path = fs::absolute(TruthOfRun(*request.truth, request.dataset)).string();
  if (!dataset.truth_path.empty()) RequireTruth(dataset.truth_path);
  return dataset;
}

// What cannot fit is known before any work is done.
void RequireMemory(const PartRequest& request, const Dataset& dataset) {
  const PartOptions& options = request.options;
  const StageGraph recipe = MakeRecipe(request.technique, {}, {}, options);
  const auto stages = recipe.StageNames();
  const auto is_done = [&](const char* stage) {
    if (!std::ranges::count(stages, stage)) return false;
    return !request.until ||
           recipe.Ancestors(recipe.IndexOf(*request.until))[recipe.IndexOf(stage)];
  };
  if (is_done("features")) RequireMemoryForFeatures(dataset.rig, request.memory_mb);
  if (!is_done("dense")) return;
  const double view_mb =
      RequireMemoryForDepth(dataset.rig, options.dense, options.masks, request.memory_mb);
  if (!is_done("fusion")) return;
  RequireMemoryForFusion(dataset.frames.size(), view_mb, options.fusion, request.memory_mb);
}

}  // namespace

std::string ReasonOf(const std::exception& error) {
  if (const auto* of_file = dynamic_cast<const fs::filesystem_error*>(&error)) {
    return Legible(fmt::format("{}: {}", of_file->path1().string(), of_file->code().message()));
  }
  std::string reason = error.what();
  while (!reason.empty() && reason.back() == '\n') reason.pop_back();  // as OpenCV ends it
  return Legible(reason);
}

PartResult ReconstructPart(const PartRequest& request) {
  cv::setNumThreads(1);  // of every part in this process: the work is split over frames
  Job job(request.threads, request.quiet, request.sharing);
  const auto recipe = [&](const Dataset& dataset, const DatasetContent& content) {
    return MakeRecipe(request.technique, dataset, content, request.options);
  };
  return job.Run([&] {
    Dataset dataset = OpenWithTruth(request);
    RequireMemory(request, dataset);
    return RunInFolder({request, NameOf(request.technique), recipe}, std::move(dataset), job);
  });
}

}  // namespace rigmap
