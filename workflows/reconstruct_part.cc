#include "workflows/reconstruct_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <opencv2/core.hpp>

#include "core/error.h"
#include "dataset/open_dataset.h"
#include "workflows/evaluate_part.h"
#include "workflows/run_in_folder.h"
#include "workflows/stages/compare_result.h"
#include "workflows/stages/dense.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

// The dataset with the truth that it is to be compared with, which can be read. Known to be wrong
// now, not when all work is done.
Dataset OpenWithTruth(const PartRequest& request) {
  Dataset dataset = OpenDataset(request.dataset);
  if (request.truth) dataset.truth_path = fs::absolute(TruthFile(*request.truth)).string();
  if (!dataset.truth_path.empty()) RequireTruth(dataset.truth_path);
  return dataset;
}

bool MatchesDensely(const PartRequest& request) {
  const StageGraph recipe = MakeRecipe(request.technique, {}, {}, request.options);
  const auto stages = recipe.StageNames();
  if (!std::ranges::count(stages, "dense")) return false;
  return !request.until ||
         recipe.Ancestors(recipe.IndexOf(*request.until))[recipe.IndexOf("dense")];
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
    if (MatchesDensely(request)) {
      const PartOptions& o = request.options;
      RequireMemoryForDepth(dataset.rig, o.dense, o.masks, request.memory_mb);
    }
    return RunInFolder({request, NameOf(request.technique), recipe}, std::move(dataset), job);
  });
}

}  // namespace rigmap
