#include "workflows/reconstruct_part.h"

#include <filesystem>
#include <opencv2/core.hpp>

#include "dataset/open_dataset.h"
#include "workflows/evaluate_part.h"
#include "workflows/run_in_folder.h"
#include "workflows/stages/compare_result.h"

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

}  // namespace

PartResult ReconstructPart(const PartRequest& request) {
  cv::setNumThreads(1);  // of every part in this process: the work is split over frames
  Job job(request.threads, request.quiet, request.sharing);
  const auto recipe = [&](const Dataset& dataset, const DatasetContent& content) {
    return MakeRecipe(request.technique, dataset, content, request.options);
  };
  return job.Run([&] {
    return RunInFolder({request, NameOf(request.technique), recipe}, OpenWithTruth(request), job);
  });
}

}  // namespace rigmap
